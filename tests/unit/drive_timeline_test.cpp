// SPDX-License-Identifier: Apache-2.0
// Drive and positions at their own times reach the identification in order, or are counted.
#include "condyle/estimator/drive_timeline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace condyle {
namespace {

constexpr TimeNs kStep_ns = 12'000'000;
constexpr double kSd_m = 5e-5;

double drive_at(TimeNs time_ns) {
  return 0.3 * std::sin(8 * seconds(time_ns));
}

double position_at(TimeNs time_ns) {
  return -0.01 * std::sin(8 * seconds(time_ns));
}

class Timeline : public testing::Test {
 protected:
  void add_drive(DriveTimeline<double>& timeline, TimeNs time_ns, TimeNs late_ns = 0) {
    timeline.add_drive(time_ns + late_ns, drive_at(time_ns));
  }
  void add_position(DriveTimeline<double>& timeline, TimeNs time_ns) {
    timeline.add_position(time_ns, position_at(time_ns), kSd_m);
  }
  void expect_same(const DriveTimeline<double>& a, const JointEstimate<double>& b) {
    const JointEstimate<double> estimate = a.estimate();
    EXPECT_EQ(estimate.friction_Ns_m.fitted, b.friction_Ns_m.fitted);
    EXPECT_EQ(estimate.mass_kg.fitted, b.mass_kg.fitted);
    EXPECT_EQ(estimate.mass_kg.filter_sd, b.mass_kg.filter_sd);
    EXPECT_EQ(estimate.position_m, b.position_m);
  }

  JointParameters parameters_;
};

// With lines through what keeps the mean of the drive over a step.
TEST_F(Timeline, IsTheStageWhereBothAreMeasuredAtOnce) {
  DriveTimeline<double> timeline(parameters_);
  JointIdentification<double> stage(parameters_);
  for (TimeNs t = 0; t < 300 * kStep_ns; t += kStep_ns) {
    add_drive(timeline, t);
    add_position(timeline, t);
    const double curved =
        drive_at(t + kStep_ns) - 2 * drive_at(t) + drive_at(t > 0 ? t - kStep_ns : 0);
    const double held_N = drive_at(t) - (t > 0 ? curved / 12 : 0);
    const auto estimate = stage.step(seconds(t == 0 ? 0 : kStep_ns), held_N, position_at(t), kSd_m);
    EXPECT_NEAR(estimate.position_m, position_at(t), 1e-3);
  }
  add_drive(timeline, 300 * kStep_ns);
  const auto actual = timeline.estimate(), expected = stage.estimate();
  EXPECT_NEAR(actual.mass_kg.fitted, expected.mass_kg.fitted, 1e-9);
  EXPECT_NEAR(actual.friction_Ns_m.fitted, expected.friction_Ns_m.fitted, 1e-9);
  EXPECT_NEAR(actual.mass_kg.filter_sd, expected.mass_kg.filter_sd, 1e-9);
  const double mean_N = 0.3 / 8 * (std::cos(8 * 0.120) - std::cos(8 * 0.132)) / 0.012;
  const auto held = [](TimeNs t) {
    return drive_at(t) - (drive_at(t + kStep_ns) - 2 * drive_at(t) + drive_at(t - kStep_ns)) / 12;
  };
  EXPECT_NEAR((held(10 * kStep_ns) + held(11 * kStep_ns)) / 2, mean_N, 1e-5 * std::abs(mean_N));
}

// Whichever comes first.
TEST_F(Timeline, LetsPositionsWaitForTheDrive) {
  DriveTimeline<double> early(parameters_), late(parameters_);
  for (TimeNs t = 0; t < 300 * kStep_ns; t += kStep_ns) {
    add_drive(early, t);
    if (t > 0) add_position(early, t - kStep_ns / 3);
    add_position(late, t + 2 * kStep_ns / 3);
    add_drive(late, t);
  }
  add_position(early, 300 * kStep_ns - kStep_ns / 3);
  for (DriveTimeline<double>* const timeline : {&early, &late}) {
    add_drive(*timeline, 300 * kStep_ns);
    add_drive(*timeline, 301 * kStep_ns);
  }
  expect_same(late, early.estimate());
  EXPECT_EQ(late.counts().positions_too_early, 0U);
}

TEST_F(Timeline, TakesTheDriveBackByItsDelay) {
  DriveTimeline<double> punctual(parameters_);
  parameters_.drive.delay_s = 0.02;
  DriveTimeline<double> late(parameters_);
  for (TimeNs t = 0; t < 300 * kStep_ns; t += kStep_ns) {
    add_drive(punctual, t);
    add_position(punctual, t);
    add_drive(late, t, nanoseconds(0.02));
    add_position(late, t);
  }
  expect_same(late, punctual.estimate());
}

TEST_F(Timeline, CountsWhatItCannotUse) {
  DriveTimeline<double> timeline(parameters_);
  add_position(timeline, 0);  // before the drive
  add_drive(timeline, kStep_ns);
  add_position(timeline, kStep_ns);
  add_drive(timeline, 2 * kStep_ns);
  add_drive(timeline, 2 * kStep_ns);  // twice
  EXPECT_EQ(timeline.counts().positions_too_early, 1U);
  EXPECT_EQ(timeline.counts().drive_not_in_order, 1U);
  add_position(timeline, 20 * kStep_ns);  // waits, in what will be a gap
  add_drive(timeline, 30 * kStep_ns);
  EXPECT_EQ(timeline.counts().drive_gaps, 1U);
  add_drive(timeline, 31 * kStep_ns);
  EXPECT_EQ(timeline.counts().positions_too_early, 2U);
  add_position(timeline, 30 * kStep_ns);
  add_drive(timeline, 0);  // the clock was set back
  EXPECT_EQ(timeline.counts().drive_gaps, 2U);
  for (int i = 0; i < 70; ++i) add_position(timeline, kStep_ns + i);
  EXPECT_EQ(timeline.counts().positions_dropped, 6U);
}

// What was known before a gap is known after it; across it nothing is learned.
TEST_F(Timeline, KeepsWhatItKnowsThroughAGap) {
  DriveTimeline<double> timeline(parameters_);
  for (TimeNs t = 0; t < 300 * kStep_ns; t += kStep_ns) {
    add_drive(timeline, t);
    add_position(timeline, t);
  }
  add_drive(timeline, 300 * kStep_ns);
  const JointEstimate<double> before = timeline.estimate();
  add_drive(timeline, 400 * kStep_ns);
  add_position(timeline, 400 * kStep_ns);
  add_drive(timeline, 401 * kStep_ns);
  const JointEstimate<double> after = timeline.estimate();
  EXPECT_EQ(after.mass_kg.fitted, before.mass_kg.fitted);
  EXPECT_EQ(after.mass_kg.filter_sd, before.mass_kg.filter_sd);
  EXPECT_EQ(after.position_m, position_at(400 * kStep_ns));
}

// The longest gap is one that is bridged.
TEST_F(Timeline, BridgesTheLongestGap) {
  const TimeNs longest_ns = nanoseconds(parameters_.drive.longest_gap_s);
  DriveTimeline<double> timeline(parameters_);
  timeline.add_drive(0, 0.1);
  timeline.add_drive(longest_ns, 0.1);
  EXPECT_EQ(timeline.counts().drive_gaps, 0U);
  timeline.add_drive(2 * longest_ns + 1, 0.1);
  EXPECT_EQ(timeline.counts().drive_gaps, 1U);
}

// A drive that does not change needs no correction for a curve, before a gap either.
TEST_F(Timeline, HoldsAConstantDriveAsItIs) {
  DriveTimeline<double> timeline(parameters_);
  JointIdentification<double> stage(parameters_);
  constexpr double kDrive_N = 0.1;
  for (int i = 0; i < 60; ++i) {
    const int after_gap = i < 30 ? 0 : 100;
    const double position_m = 1e-3 * i * i;
    timeline.add_drive((i + after_gap) * kStep_ns, kDrive_N);
    timeline.add_position((i + after_gap) * kStep_ns, position_m, kSd_m);
    if (i == 30) stage.interrupt();
    (void)stage.step(seconds(kStep_ns), kDrive_N, position_m, kSd_m);
  }
  timeline.add_drive(160 * kStep_ns, kDrive_N);
  EXPECT_EQ(timeline.counts().drive_gaps, 1U);
  const auto actual = timeline.estimate(), expected = stage.estimate();
  EXPECT_NEAR(actual.mass_kg.fitted, expected.mass_kg.fitted, 1e-10);
  EXPECT_NEAR(actual.friction_Ns_m.fitted, expected.friction_Ns_m.fitted, 1e-10);
  EXPECT_NEAR(actual.position_m, expected.position_m, 1e-12);
}

TEST_F(Timeline, OutlastsExtremeTimes) {
  DriveTimeline<double> timeline(parameters_);
  for (const TimeNs t : {std::numeric_limits<TimeNs>::min(), std::numeric_limits<TimeNs>::max(),
                         TimeNs{0}, std::numeric_limits<TimeNs>::max()}) {
    timeline.add_drive(t, 1);
    timeline.add_position(t, 0.001, kSd_m);
  }
  EXPECT_TRUE(std::isfinite(timeline.estimate().mass_kg.fitted));
}

}  // namespace
}  // namespace condyle
