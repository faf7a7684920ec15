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
  EXPECT_TRUE(checker.check(at(35)).has(Event::time_reversed));
  EXPECT_TRUE(checker.check(at(45)).empty()) << "compared with the sample before it";
  Sample sample = at(55);
  sample.position_valid = false;
  EXPECT_TRUE(checker.check(sample).has(Event::position_missing));
  sample = at(0);
  sample.time_valid = false;
  EXPECT_TRUE(checker.check(sample).has(Event::time_missing));
  EXPECT_TRUE(checker.check(at(65)).empty());
}

TEST(SampleChecker, SurvivesTheEndsOfTime) {
  SampleChecker checker(10);
  checker.check(at(std::numeric_limits<TimeNs>::min()));
  EXPECT_TRUE(checker.check(at(std::numeric_limits<TimeNs>::max())).has(Event::time_gap));
  EXPECT_TRUE(checker.check(at(std::numeric_limits<TimeNs>::min())).has(Event::time_reversed));
}

TEST(SampleChecker, TakesRepeatedZerosOfAPointForADropout) {
  SampleChecker checker;
  Sample sample;
  sample.kind = SampleKind::one_point;
  EXPECT_FALSE(checker.check(sample).has(Event::zero_filled)) << "one may be true";
  EXPECT_TRUE(checker.check(sample).has(Event::zero_filled));
  sample.coordinates[2] = 1e-5;
  EXPECT_FALSE(checker.check(sample).has(Event::zero_filled));
  sample = Sample{};  // along one axis zero is a position like any other
  checker.check(sample);
  EXPECT_FALSE(checker.check(sample).has(Event::zero_filled));
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
