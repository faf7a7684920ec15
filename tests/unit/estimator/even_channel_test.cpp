// SPDX-License-Identifier: Apache-2.0
// A channel learns its step, averages what comes too fast, and ends a segment at a gap.
#include "condyle/estimator/impedance/even_channel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace condyle {
namespace {

using Channel = EvenChannel<double, 64>;
constexpr auto kNothing = [] {};

TEST(EvenChannel, LearnsItsStepAndKeepsTheLatest) {
  Channel channel(1'000'000, kNanosecondsPerSecond);
  for (TimeNs k = 0; k < 16; ++k) channel.add(k * 5'000'000, static_cast<double>(k), kNothing);
  EXPECT_FALSE(channel.is_learned());
  for (TimeNs k = 16; k < 200; ++k) channel.add(k * 5'000'000, static_cast<double>(k), kNothing);
  EXPECT_TRUE(channel.is_learned());
  EXPECT_DOUBLE_EQ(channel.step_s(), 0.005);
  EXPECT_EQ(channel.end(), 200U);
  EXPECT_EQ(channel.begin(), 200U - 64);
  EXPECT_EQ(channel.value(150), 150);
  EXPECT_EQ(channel.time_ns(150), 150 * 5'000'000);
  EXPECT_DOUBLE_EQ(channel.width_s(150), 0.005);
  EXPECT_NEAR(channel.noise().variance, 0, 1e-12);
  EXPECT_EQ(channel.take_noise().count, 194);
  EXPECT_EQ(channel.noise().count, 0);
}

TEST(EvenChannel, AveragesWhatComesTooFast) {
  Channel channel(1'000'000, kNanosecondsPerSecond);
  for (TimeNs k = 0; k < 1000; ++k) channel.add(k * 250'000, static_cast<double>(k), kNothing);
  EXPECT_DOUBLE_EQ(channel.step_s(), 0.001);
  EXPECT_NEAR(static_cast<double>(channel.end()), 250, 1);
  const std::uint64_t last = channel.end() - 1;
  EXPECT_NEAR(channel.value(last), seconds(channel.time_ns(last)) / 250e-6, 1e-6);
}

TEST(EvenChannel, EndsASegmentAtAGapAndTellsBefore) {
  Channel channel(1'000'000, kNanosecondsPerSecond);
  std::uint64_t seen = 0;
  const auto before_gap = [&] { seen = channel.end() - channel.begin(); };
  TimeNs t = 0;
  for (TimeNs k = 0; k < 40; ++k) channel.add(t += 10'000'000, 0, before_gap);
  EXPECT_EQ(channel.counts().gaps, 0U);
  channel.add(t += 36'000'000, 0, before_gap);
  EXPECT_EQ(channel.counts().gaps, 1U);
  EXPECT_EQ(seen, 40U);
  EXPECT_EQ(channel.end() - channel.begin(), 1U);
  channel.add(t - 1'000'000, 0, before_gap);  // a little before: left out
  EXPECT_EQ(channel.counts().not_in_order, 1U);
  channel.add(t - kNanosecondsPerSecond, 0, before_gap);  // the clock was set back
  EXPECT_EQ(channel.counts().gaps, 2U);
  channel.add(std::numeric_limits<TimeNs>::max(), 0, before_gap);
  channel.add(std::numeric_limits<TimeNs>::min(), 0, before_gap);
  EXPECT_EQ(channel.counts().gaps, 4U);
}

TEST(EvenChannel, HasALongestGapOfItsOwn) {
  Channel channel(1'000'000, 15'000'000);
  for (TimeNs k = 0; k < 40; ++k) channel.add(k * 10'000'000, 0, kNothing);
  channel.add(410'000'000, 0, kNothing);
  EXPECT_EQ(channel.counts().gaps, 1U);
}

}  // namespace
}  // namespace condyle
