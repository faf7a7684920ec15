// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/changes/change_detector.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"

namespace condyle {
namespace {

constexpr double kSd_Ns_m = 0.035;

// `count` cycles about `friction_Ns_m`.
template <class Scalar>
void add_cycles(ChangeDetector<Scalar>& detector, testing_support::Random& random, int count,
                double friction_Ns_m, double said_sd = kSd_Ns_m) {
  for (int i = 0; i < count; ++i) {
    const double x = friction_Ns_m + kSd_Ns_m * random.normal();
    (void)detector.add(static_cast<Scalar>(x), static_cast<Scalar>(said_sd));
  }
}

TEST(ChangeDetector, LearnsFirst) {
  ChangeDetector<double> detector({});
  testing_support::Random random(1);
  add_cycles(detector, random, 70, 0.022);
  add_cycles(detector, random, 8, 10);
  EXPECT_EQ(detector.state(), ChangeState::learning);
  EXPECT_EQ(detector.cycles(), 78);
  EXPECT_TRUE(std::isnan(detector.change().after_Ns_m));
}

TEST(ChangeDetector, NoSingleCycleMakesAnAlarm) {
  for (const double wild : {-1e6, -1.0, 1.0, 1e6}) {
    ChangeDetector<double> detector({});
    testing_support::Random random(2);
    add_cycles(detector, random, 200, 0.022);
    EXPECT_EQ(detector.add(wild, 0.001), ChangeState::watching) << wild;
    EXPECT_GT(detector.statistic(), 0);
    EXPECT_LT(detector.spread(), 1.2) << "nor does it blind the detector";
  }
}

TEST(ChangeDetector, SaysWhichWayFromWhereAndWhen) {
  for (const double after : {0.2, -0.15}) {
    ChangeDetector<double> detector({});
    testing_support::Random random(3);
    add_cycles(detector, random, 300, 0.022);
    EXPECT_EQ(detector.state(), ChangeState::watching);
    add_cycles(detector, random, 20, after);
    EXPECT_EQ(detector.state(), after > 0 ? ChangeState::increased : ChangeState::decreased);
    const DampingChange<double>& change = detector.change();
    EXPECT_NEAR(change.before_Ns_m, 0.022, 3 * change.before_sd);
    EXPECT_NEAR(change.after_Ns_m, after, 3 * change.after_sd);
    EXPECT_NEAR(change.before_sd, kSd_Ns_m / std::sqrt(300), 0.0005);
    EXPECT_EQ(change.first_after, 300);
    EXPECT_GE(change.alarm, 301);
    EXPECT_LT(change.alarm, 306);
  }
}

TEST(ChangeDetector, KeepsTheAlarmUntilReset) {
  ChangeDetector<double> detector({});
  testing_support::Random random(4);
  add_cycles(detector, random, 100, 0.022);
  add_cycles(detector, random, 20, 0.3);
  EXPECT_EQ(detector.state(), ChangeState::increased);
  const std::int64_t cycles = detector.cycles();
  const double size = detector.change().after_Ns_m;
  add_cycles(detector, random, 100, 0.022);
  EXPECT_EQ(detector.state(), ChangeState::increased);
  EXPECT_EQ(detector.cycles(), cycles);
  EXPECT_EQ(detector.change().after_Ns_m, size);
  detector.reset();
  EXPECT_EQ(detector.state(), ChangeState::learning);
  EXPECT_EQ(detector.cycles(), 0);
  EXPECT_TRUE(std::isnan(detector.change().after_Ns_m));
  add_cycles(detector, random, 100, 0.3);
  EXPECT_EQ(detector.state(), ChangeState::watching) << "0.3 is the new baseline";
}

// Standard deviations that are all wrong by one factor change the spread and nothing else.
TEST(ChangeDetector, NeedsStandardDeviationsOnlyUpToAFactor) {
  ChangeDetector<double> right({}), wrong({});
  testing_support::Random one(5), other(5);
  add_cycles(right, one, 300, 0.022);
  add_cycles(wrong, other, 300, 0.022, kSd_Ns_m / 3);
  EXPECT_NEAR(right.spread(), 1, 0.1);
  EXPECT_NEAR(wrong.spread(), 3 * right.spread(), 1e-9);
  EXPECT_NEAR(wrong.threshold(), right.threshold(), 1e-9);
  EXPECT_NEAR(wrong.statistic(), right.statistic(), 1e-9);
  add_cycles(right, one, 20, 0.15);
  add_cycles(wrong, other, 20, 0.15, kSd_Ns_m / 3);
  EXPECT_EQ(right.state(), ChangeState::increased);
  EXPECT_EQ(wrong.change().alarm, right.change().alarm);
  EXPECT_NEAR(wrong.change().after_sd, right.change().after_sd, 1e-9);
}

// The threshold is the one for the interval: Siegmund's formula gives it back.
TEST(ChangeDetector, ThresholdFollowsTheInterval) {
  for (const double interval : {100.0, 5000.0, 37440.0, 1e7}) {
    ChangeParameters parameters;
    parameters.false_alarm_cycles = interval;
    ChangeDetector<double> detector(parameters);
    for (int i = 0; i < 1000; ++i) (void)detector.add(0.022 + (i % 2 == 0 ? 0.03 : -0.03), 0.03);
    const double d = 0.05 / (0.03 * detector.spread());
    const double a = detector.threshold() + 1.166 * d - 0.012 * d * d;
    EXPECT_NEAR((std::exp(a) - a - 1) / (d * d / 2) / 2, interval, 0.01 * interval);
  }
}

// One false alarm in 37440 cycles, however small the change that is looked for.
TEST(ChangeDetector, HardlyEverAlarmsFalselyWhateverMatters) {
  for (const double change_Ns_m : {1e-9, 1e-4, 1e-2, 1.0, 1e6}) {
    ChangeDetector<double> detector({.change_Ns_m = change_Ns_m});
    testing_support::Random random(7);
    add_cycles(detector, random, 1000, 0.022);
    EXPECT_EQ(detector.state(), ChangeState::watching) << change_Ns_m;
  }
}

TEST(ChangeDetector, CyclesThatAreAllTheSameAreNoAlarm) {
  ChangeDetector<float> detector({});
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE((detector.add(0.022F, 0.035F), detector.is_alarm()));
}

TEST(ChangeDetector, FloatIsAsGood) {
  ChangeDetector<double> in_double({});
  ChangeDetector<float> in_float({});
  testing_support::Random one(6), other(6);
  add_cycles(in_double, one, 20000, 0.022);
  add_cycles(in_float, other, 20000, 0.022);
  EXPECT_NEAR(static_cast<double>(in_float.spread()), in_double.spread(), 1e-4);
  EXPECT_NEAR(static_cast<double>(in_float.statistic()), in_double.statistic(), 2e-3);
  add_cycles(in_double, one, 20, 0.15);
  add_cycles(in_float, other, 20, 0.15);
  EXPECT_EQ(in_float.state(), ChangeState::increased);
  EXPECT_EQ(in_float.change().alarm, in_double.change().alarm);
  EXPECT_NEAR(static_cast<double>(in_float.change().before_Ns_m), in_double.change().before_Ns_m,
              1e-5);
  EXPECT_NEAR(static_cast<double>(in_float.change().after_Ns_m), in_double.change().after_Ns_m,
              1e-5);
}

TEST(ChangeParameters, AreChecked) {
  EXPECT_TRUE(is_valid(ChangeParameters{}));
  EXPECT_TRUE(is_valid(CycleParameters{}));
  EXPECT_TRUE(is_valid(DampingBaseline{}));
  EXPECT_FALSE(is_valid(ChangeParameters{.change_Ns_m = 0}));
  EXPECT_FALSE(is_valid(ChangeParameters{.false_alarm_cycles = std::nan("")}));
  EXPECT_FALSE(is_valid(ChangeParameters{.baseline_cycles = 3}));
  EXPECT_FALSE(is_valid(CycleParameters{.shortest_s = 4}));
  EXPECT_FALSE(is_valid(DampingBaseline{.mass_kg = 0}));
}

}  // namespace
}  // namespace condyle
