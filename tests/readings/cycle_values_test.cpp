// SPDX-License-Identifier: Apache-2.0
// Values of cycles from several threads. Runs under the thread sanitizer too.
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "readings/cycle_values.h"

namespace condyle::host {
namespace {

constexpr double kRate_Hz = 60, kPeriod_s = 0.8;
constexpr std::size_t kCycles = 9;

// A point below the middle of the measured ones goes down and back, with a turn.
struct Chewing {
  ReferredMotion motion{Eigen::Vector3d::Zero(), {}, {}};
  PoseNoise noise;
  TaskContext context;
  std::vector<CycleToRead> cycles;

  Chewing() {
    const auto samples_of_cycle = static_cast<std::size_t>(std::lround(kRate_Hz * kPeriod_s));
    for (std::size_t k = 0; k <= samples_of_cycle * kCycles; ++k) {
      const double time_s = static_cast<double>(k) / kRate_Hz;
      const double share = (1 - std::cos(2 * std::numbers::pi * time_s / kPeriod_s)) / 2;
      Vector6 place = Vector6::Zero();
      place[0] = -0.002 * share;
      place[2] = -0.012 * share;
      place[4] = 0.1 * share;
      motion.time_s.push_back(time_s);
      motion.motion.push_back(place);
    }
    noise.covariance.diagonal() << 1e-9, 1e-9, 1e-9, 1e-7, 1e-7, 1e-7;
    noise.root = noise.covariance.diagonal().cwiseSqrt().asDiagonal();
    context.motion = &motion;
    context.noise = &noise;
    context.has_landmarks = true;
    context.errors.geometry.has_landmarks = true;
    context.errors.geometry.incisor_m = {0.08, 0, -0.04};
    for (std::size_t i = 0; i < kCycles; ++i) {
      ChewingCycle cycle;
      cycle.begin = i * samples_of_cycle;
      cycle.turn = cycle.begin + samples_of_cycle / 2;
      cycle.end = cycle.begin + samples_of_cycle;
      cycle.begin_s = motion.time_s[cycle.begin];
      cycle.end_s = motion.time_s[cycle.end];
      cycles.push_back({cycle, 1e-5});
    }
  }
};

// All numbers as bits, which compare even where they are NaN.
std::vector<std::uint64_t> bits_of(const UncertainValue& value) {
  std::vector<double> numbers = {value.value, value.noise_sd, value.systematic()};
  numbers.insert(numbers.end(), value.fixed.begin(), value.fixed.end());
  std::vector<std::uint64_t> bits;
  for (const double number : numbers) bits.push_back(std::bit_cast<std::uint64_t>(number));
  return bits;
}

TEST(CycleValues, DoNotDependOnTheNumberOfThreads) {
  const Chewing chewing;
  const auto one = values_of_cycles(chewing.cycles, chewing.context, 1);
  ASSERT_EQ(one.size(), kCycles);
  for (const unsigned threads : {2U, 5U}) {
    const auto several = values_of_cycles(chewing.cycles, chewing.context, threads);
    ASSERT_EQ(several.size(), kCycles);
    for (std::size_t i = 0; i < kCycles; ++i) {
      ASSERT_EQ(several[i].size(), one[i].size());
      for (std::size_t k = 0; k < one[i].size(); ++k) {
        EXPECT_EQ(bits_of(several[i][k]), bits_of(one[i][k])) << "cycle " << i << ", value " << k;
      }
    }
  }
}

// Draws in common would make the mean of many cycles less certain than their number says.
TEST(CycleValues, EachCycleDrawsNoiseOfItsOwn) {
  Chewing chewing;
  chewing.cycles.assign(2, chewing.cycles[4]);
  const auto values = values_of_cycles(chewing.cycles, chewing.context);
  ASSERT_EQ(values.size(), 2U);
  EXPECT_GT(values[0][0].noise_sd, 0);
  EXPECT_NE(values[0][0].noise_sd, values[1][0].noise_sd);
}

TEST(CycleValues, OfNoCycleAreNone) {
  const Chewing chewing;
  EXPECT_TRUE(values_of_cycles({}, chewing.context).empty());
}

}  // namespace
}  // namespace condyle::host
