// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>

#include "condyle/estimator/sample.h"

namespace condyle {
namespace {

Sample at(TimeNs time_ns) {
  Sample sample;
  sample.time_ns = time_ns;
  sample.coordinates[0] = 0.001;
  return sample;
}

TEST(Events, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < kEventCount; ++i) names.insert(event_name(static_cast<Event>(i)));
  EXPECT_EQ(names.size(), kEventCount);
  EXPECT_STREQ(event_name(Event::parameters_invalid), "parameters_invalid");
}

TEST(SampleChecker, NamesWhatIsUnusual) {
  SampleChecker checker(10);
  EXPECT_TRUE(checker.check(at(0)).empty());
  EXPECT_TRUE(checker.check(at(10)).empty());
  EXPECT_TRUE(checker.check(at(25)).empty());
  EXPECT_TRUE(checker.check(at(41)).has(Event::time_gap));
  EXPECT_TRUE(checker.check(at(41)).has(Event::time_repeated));
  EXPECT_TRUE(checker.check(at(2)).has(Event::time_reversed));
  EXPECT_TRUE(checker.check(at(51)).empty()) << "compared with the last accepted one";
  Sample sample = at(61);
  sample.position_valid = false;
  EXPECT_TRUE(checker.check(sample).has(Event::position_missing));
  sample = at(0);
  sample.time_valid = false;
  EXPECT_TRUE(checker.check(sample).has(Event::time_missing));
  EXPECT_TRUE(checker.check(at(71)).empty());
}

TEST(SampleChecker, NamesNoGapWithoutANominalStep) {
  SampleChecker checker;
  for (TimeNs time_ns = 1; time_ns < TimeNs{1} << 60; time_ns *= 3) {
    EXPECT_TRUE(checker.check(at(time_ns)).empty()) << time_ns;
  }
}

TEST(SampleChecker, NamesPositionsBeyondTenMetres) {
  SampleChecker checker;
  for (const SampleKind kind :
       {SampleKind::one_axis, SampleKind::one_point, SampleKind::three_points, SampleKind::pose}) {
    const std::size_t lengths = kind == SampleKind::pose ? 3 : coordinate_count(kind);
    for (std::size_t i = 0; i < coordinate_count(kind); ++i) {
      Sample sample;
      sample.kind = kind;
      for (const double far_m : {10.0000001, -12.0, -3.7e28, 1e5, 1.7e308}) {
        sample.coordinates[i] = far_m;
        EXPECT_EQ(is_out_of_range(kind, sample.coordinates), i < lengths) << far_m << ' ' << i;
        EXPECT_EQ(checker.check(sample).has(Event::position_out_of_range), i < lengths);
      }
      for (const double near_m : {9.999, 10.0, -10.0, 0.0}) {
        sample.coordinates[i] = near_m;
        EXPECT_FALSE(is_out_of_range(kind, sample.coordinates)) << near_m;
      }
      for (const double none :
           {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        sample.coordinates[i] = none;
        EXPECT_FALSE(is_out_of_range(kind, sample.coordinates)) << "no number, only missing";
      }
    }
  }
}

TEST(SampleChecker, SurvivesTheEndsOfTime) {
  SampleChecker checker(10);
  checker.check(at(std::numeric_limits<TimeNs>::min()));
  EXPECT_TRUE(checker.check(at(std::numeric_limits<TimeNs>::max())).has(Event::time_gap));
  EXPECT_TRUE(checker.check(at(std::numeric_limits<TimeNs>::min())).has(Event::time_reversed));
}

TEST(SampleChecker, FollowsAClockThatWasSetBack) {
  SampleChecker checker(10);
  checker.check(at(1000));
  EXPECT_TRUE(checker.check(at(0)).has(Event::time_reversed));
  EXPECT_TRUE(checker.check(at(10)).has(Event::time_reversed));
  const EventSet third = checker.check(at(20));
  EXPECT_TRUE(third.has(Event::time_restarted));
  EXPECT_FALSE(third.has(Event::time_reversed));
  EXPECT_FALSE(third.has(Event::time_gap));
  EXPECT_TRUE(checker.check(at(30)).empty());
  // Out of order among themselves, they restart nothing.
  for (const TimeNs time_ns : {20, 10, 5, 4, 3}) {
    EXPECT_TRUE(checker.check(at(time_ns)).has(Event::time_reversed)) << time_ns;
  }
}

Sample point_at(double x_m, double z_m) {
  Sample sample;
  sample.kind = SampleKind::one_point;
  sample.coordinates[0] = x_m;
  sample.coordinates[2] = z_m;
  return sample;
}

TEST(SampleChecker, TakesZerosFromAfarOrRepeatedForADropout) {
  const auto is_filled = [](SampleChecker& checker, const Sample& sample) {
    return checker.check(sample).has(Event::zero_filled);
  };
  SampleChecker checker;
  EXPECT_FALSE(is_filled(checker, point_at(0, 0))) << "a recording may start at its origin";
  EXPECT_TRUE(is_filled(checker, point_at(0, 0)));
  EXPECT_FALSE(is_filled(checker, point_at(0, 1e-5)));
  EXPECT_FALSE(is_filled(checker, point_at(0, 0))) << "the jaw may pass the origin";
  EXPECT_FALSE(is_filled(checker, point_at(0, -0.02)));
  EXPECT_TRUE(is_filled(checker, point_at(0, 0))) << "but not from 20 mm away";
  Sample along_one_axis;
  SampleChecker axis;
  axis.check(along_one_axis);
  EXPECT_FALSE(is_filled(axis, along_one_axis));

  Sample points;
  points.kind = SampleKind::three_points;
  for (int i = 0; i < 9; ++i) points.coordinates[i] = 0.05;
  SampleChecker second(0, false, {2, Axis::z}), third(0, false, {3, Axis::z});
  second.check(points);
  third.check(points);
  for (int i = 3; i < 6; ++i) points.coordinates[i] = 0;
  EXPECT_TRUE(is_filled(second, points));
  EXPECT_FALSE(is_filled(third, points));
}

TEST(SampleChecker, MissesADriveOnlyWhereOneIsExpected) {
  EXPECT_FALSE(SampleChecker(0, false).check(at(0)).has(Event::drive_missing));
  EXPECT_TRUE(SampleChecker(0, true).check(at(0)).has(Event::drive_missing));
}

TEST(Sample, FollowsTheChosenCoordinate) {
  Sample sample;
  for (int i = 0; i < 9; ++i) sample.coordinates[i] = i;
  EXPECT_EQ(followed_position_m(sample, {3, Axis::y}), 0);
  sample.kind = SampleKind::three_points;
  EXPECT_EQ(followed_position_m(sample, {1, Axis::z}), 2);
  EXPECT_EQ(followed_position_m(sample, {3, Axis::y}), 7);
  EXPECT_TRUE(is_available(sample.kind, {3, Axis::y}));
  EXPECT_FALSE(is_available(sample.kind, {4, Axis::y}));
  sample.kind = SampleKind::pose;
  EXPECT_EQ(followed_position_m(sample, {1, Axis::y}), 1);
  EXPECT_FALSE(is_available(sample.kind, {2, Axis::y}));
}

}  // namespace
}  // namespace condyle
