// SPDX-License-Identifier: Apache-2.0
// What narrower windows show: noise hardly widens an interval, what repeats widens all of them.
#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "readings/reading.h"
#include "support/acceptance.h"
#include "support/random.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using testing_support::Random;

constexpr double kFalseAlarm = 1e-6;
constexpr int kCycles = 16;

// Values whose contradiction is `common`, with noise of standard deviation 1.
std::vector<UncertainValue> contradicted(double common, Random& random) {
  std::vector<UncertainValue> values(kCycles);
  for (UncertainValue& value : values) {
    value.value = 5;
    value.contradiction = common + random.normal();
    value.contradiction_sd = 1;
  }
  return values;
}

std::vector<UncertainValue*> pointers_to(std::vector<UncertainValue>& values) {
  std::vector<UncertainValue*> pointers;
  for (UncertainValue& value : values) pointers.push_back(&value);
  return pointers;
}

// Beyond two standard deviations: 4.6 % of normal errors. The mean square of 16 exceeds its mean by
// two of its standard deviations in 3.9 % (chi-square).
TEST(Contradictions, OfNoiseWidenFewIntervals) {
  Random random(1);
  constexpr int kTasks = 2000;
  std::uint64_t cycles = 0, means = 0, shared = 0;
  for (int task = 0; task < kTasks; ++task) {
    auto values = contradicted(0, random);
    means += mean_of(values).systematic() > 0;
    cycles += values[0].systematic() > 0;
    share_contradictions(pointers_to(values));
    shared += values[0].doubt > 0;
  }
  EXPECT_LE(cycles, testing_support::most_hits(kTasks, 0.046, kFalseAlarm));
  EXPECT_LE(means, testing_support::most_hits(kTasks, 0.046, kFalseAlarm));
  EXPECT_LE(shared, testing_support::most_hits(kTasks, 0.039, kFalseAlarm));
}

// One cycle hides an error of 1.5 standard deviations, 16 do not.
TEST(Contradictions, ThatRepeatAreInAllIntervals) {
  Random random(2);
  constexpr int kTasks = 200;
  for (const double common : {1.5, -1.5, 3.0, 10.0}) {
    std::uint64_t means = 0, cycles = 0;
    for (int task = 0; task < kTasks; ++task) {
      auto values = contradicted(common, random);
      means += mean_of(values).half_interval() >= std::abs(common);
      share_contradictions(pointers_to(values));
      cycles += values[0].half_interval() >= std::abs(common);
    }
    EXPECT_GE(means, 0.99 * kTasks) << common;
    EXPECT_GE(cycles, 0.9 * kTasks) << common;
  }
}

TEST(Contradictions, BeyondTheLimitAreTheReason) {
  UncertainValue value;
  value.value = 1;
  value.contradiction = 1;
  EXPECT_THAT(what_narrows(value, 0.5, "cycles"), HasSubstr("too abruptly for the smoothing"));
}

}  // namespace
}  // namespace condyle::host
