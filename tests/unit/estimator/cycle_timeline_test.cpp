// SPDX-License-Identifier: Apache-2.0
// Drive and positions at their own times reach the cycles in order, or are counted.
#include "condyle/estimator/changes/cycle_timeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "condyle/estimator/changes/change_detector.h"
#include "support/driven_chewing.h"

namespace condyle {
namespace {

using testing_support::DrivenChewing;
using Cycles = std::vector<TimedCycle<double>>;

WatchParameters short_watch() {
  WatchParameters watch;
  watch.identification_s = 20;
  return watch;
}

ImpedanceParameters impedance_parameters() {
  ImpedanceParameters parameters;
  parameters.drive.noise_sd_N = DrivenChewing::kDriveSd_N;
  return parameters;
}

TEST(CycleTimeline, IsTheStageWhereBothAreMeasuredAtOnce) {
  constexpr TimeNs kStep_ns = 20'000'000;
  DrivenChewing chewing({}, 50, 1);
  CycleTimeline<double> timeline(impedance_parameters(), short_watch());
  std::optional<CycleDamping<double>> stage;
  Cycles seen, expected;
  for (TimeNs t = 0; t < 2500 * kStep_ns; t += kStep_ns) {
    const auto sample = chewing.next();
    const auto keep = [&](const auto& cycle) { seen.push_back(cycle); };
    timeline.add_drive(t, sample.drive_N, keep);
    timeline.add_position(t, sample.position_m, DrivenChewing::kPositionSd_m, keep);
    if (stage) {
      const auto report =
          stage->step(0.02, sample.drive_N, sample.position_m, DrivenChewing::kPositionSd_m);
      if (report.outcome != CycleOutcome::none) expected.push_back({t, report});
      continue;
    }
    ASSERT_EQ(timeline.is_watching(), t == 1000 * kStep_ns) << t;
    if (!timeline.is_watching()) continue;
    ImpedanceParameters learned = impedance_parameters();
    learned.drive.noise_sd_N = timeline.identified().drive_noise_sd_N;
    EXPECT_NEAR(learned.drive.noise_sd_N, DrivenChewing::kDriveSd_N,
                0.1 * DrivenChewing::kDriveSd_N);
    stage.emplace(baseline_of(timeline.identified()), learned, CycleParameters{});
    (void)stage->step(0, sample.drive_N, sample.position_m, DrivenChewing::kPositionSd_m);
  }
  ASSERT_EQ(seen.size(), expected.size());
  EXPECT_GT(seen.size(), 30U);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_EQ(seen[i].end_ns, expected[i].end_ns);
    EXPECT_EQ(seen[i].report.outcome, expected[i].report.outcome);
    EXPECT_NEAR(seen[i].report.friction_Ns_m, expected[i].report.friction_Ns_m, 1e-12);
    EXPECT_NEAR(seen[i].report.standard_deviation, expected[i].report.standard_deviation, 1e-12);
  }
}

// The normalised error squared of 1500 cycles; positions at 60 Hz, the drive at `ticks_of_drive`
// ticks of 600 Hz, from tick 5 on. Its average leaves 0.87 to 1.13 once in 1000 times.
void expect_known_as_said(int ticks_of_drive) {
  constexpr TimeNs kTick_ns = 1'666'667;
  DrivenChewing chewing({}, 600, 2);
  CycleTimeline<double> timeline(impedance_parameters(), short_watch());
  double squares = 0, sum = 0, information = 0;
  int cycles = 0;
  const auto keep = [&](const TimedCycle<double>& cycle) {
    if (cycle.report.outcome != CycleOutcome::counted) return;
    const double error = cycle.report.friction_Ns_m - 0.022, sd = cycle.report.standard_deviation;
    squares += error * error / (sd * sd);
    sum += error;
    information += 1 / (sd * sd);
    ++cycles;
  };
  TimeNs tick = 0;
  while (cycles < 1500) {
    const auto sample = chewing.next();
    if (tick % ticks_of_drive == 5 % ticks_of_drive) {
      timeline.add_drive(tick * kTick_ns, sample.drive_N, keep);
    }
    if (tick % 10 == 0) {
      timeline.add_position(tick * kTick_ns, sample.position_m, DrivenChewing::kPositionSd_m, keep);
    }
    ++tick;
  }
  std::printf("             NEES %.3f, bias %.2g of sd %.2g Ns/m\n", squares / cycles, sum / cycles,
              std::sqrt(cycles / information));
  EXPECT_GT(squares / cycles, 0.87);
  EXPECT_LT(squares / cycles, 1.13);
}

TEST(CycleTimeline, KnowsCyclesAsSaidWithAFasterDrive) {
  expect_known_as_said(3);
}
TEST(CycleTimeline, KnowsCyclesAsSaidWithADriveBetweenThePositions) {
  expect_known_as_said(10);
}

TEST(CycleTimeline, CountsWhatIsNotInOrder) {
  DrivenChewing chewing({}, 50, 3);
  CycleTimeline<double> timeline(impedance_parameters(), short_watch());
  const auto ignore = [](const auto&) {};
  TimeNs t = 0;
  const auto add = [&](TimeNs step_ns) {
    t += step_ns;
    const auto sample = chewing.next();
    timeline.add_drive(t, sample.drive_N, ignore);
    timeline.add_position(t, sample.position_m, 5e-5, ignore);
  };
  for (int i = 0; i < 1200; ++i) add(20'000'000);
  ASSERT_TRUE(timeline.is_watching());
  timeline.add_drive(t - 5'000'000, 0, ignore);
  timeline.add_position(t - 25'000'000, 0, 5e-5, ignore);
  EXPECT_EQ(timeline.counts().drive_not_in_order, 1U);
  EXPECT_EQ(timeline.counts().positions_too_early, 1U);
  add(200'000'000);
  EXPECT_EQ(timeline.counts().drive_gaps, 1U);
  for (int i = 0; i < 70; ++i) timeline.add_position(t + 1'000'000 * (i + 1), 0, 5e-5, ignore);
  EXPECT_EQ(timeline.counts().positions_dropped, 6U);
}

// A drive that is late by 4 ms would add 0.1 Ns/m.
TEST(CycleTimeline, TakesOffTheDelayThatWasFitted) {
  ImpedanceParameters parameters = impedance_parameters();
  parameters.delay = DelayModel::fitted;
  WatchParameters watch;
  CycleTimeline<double> timeline(parameters, watch);
  DrivenChewing chewing({}, 200, 6);
  WeightedMean<double> mean;
  const auto keep = [&](const TimedCycle<double>& cycle) {
    if (cycle.report.outcome != CycleOutcome::counted) return;
    mean.add(cycle.report.friction_Ns_m,
             1 / (cycle.report.standard_deviation * cycle.report.standard_deviation));
  };
  for (TimeNs i = 0; i < 60'000; ++i) {
    const auto sample = chewing.next();
    timeline.add_drive(i * 5'000'000 + 4'000'000, sample.drive_N, keep);
    timeline.add_position(i * 5'000'000, sample.position_m, 5e-5, keep);
  }
  const auto identified = timeline.identified();
  EXPECT_NEAR(identified.delay_s.fitted, 0.004, 4 * identified.delay_s.sampling_sd);
  EXPECT_LT(identified.delay_s.sampling_sd, 5e-4);
  EXPECT_NEAR(mean.mean, 0.022, 0.015);
  EXPECT_LT(timeline.counts().positions_too_early, 5U);
}

// A cycle in which teeth or food may touch does not count.
TEST(CycleTimeline, DropsCyclesWithContact) {
  ImpedanceParameters parameters = impedance_parameters();
  CycleTimeline<double> free(parameters, short_watch());
  parameters.contact_above_m = 0.02;
  CycleTimeline<double> touching(parameters, short_watch());
  DrivenChewing chewing({}, 50, 5);
  int of_free = 0, of_touching = 0;
  for (TimeNs i = 0; i < 2500; ++i) {
    const auto sample = chewing.next();
    const TimeNs t = i * 20'000'000;
    // Every 100 samples, as of a bite.
    const double position_m = i >= 1500 && i % 100 < 3 ? 0.021 : sample.position_m;
    free.add_drive(t, sample.drive_N, [&](const auto&) { ++of_free; });
    free.add_position(t, sample.position_m, 5e-5, [&](const auto&) { ++of_free; });
    const auto count = [&](const TimedCycle<double>& cycle) {
      of_touching += cycle.report.outcome == CycleOutcome::counted ? 1 : 0;
    };
    touching.add_drive(t, sample.drive_N, count);
    touching.add_position(t, position_m, 5e-5, count);
  }
  EXPECT_EQ(touching.counts().positions_in_contact, 30U);
  EXPECT_GE(of_touching, of_free - 22);
  EXPECT_LE(of_touching, of_free - 10);
}

// A drive that is not the one that moves the point is no baseline, however long it lasts.
TEST(CycleTimeline, WaitsForAModelThatHolds) {
  DrivenChewing chewing({}, 50, 4);
  CycleTimeline<double> timeline(impedance_parameters(), short_watch());
  int cycles = 0;
  const auto count = [&](const auto&) { ++cycles; };
  for (TimeNs i = 0; i < 3000; ++i) {
    const auto sample = chewing.next();
    const double missing_N = 0.03 * std::sin(0.37 * static_cast<double>(i));
    timeline.add_drive(i * 20'000'000, sample.drive_N + missing_N, count);
    timeline.add_position(i * 20'000'000, sample.position_m, 5e-5, count);
  }
  EXPECT_FALSE(timeline.is_watching());
  EXPECT_EQ(cycles, 0);
  EXPECT_TRUE(is_failure(timeline.identified().mass_kg.limit));
}

}  // namespace
}  // namespace condyle
