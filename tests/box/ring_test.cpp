// SPDX-License-Identifier: Apache-2.0
#include "condyle/firmware/ring.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "condyle/firmware/latency_histogram.h"

namespace condyle::firmware {
namespace {

TEST(Ring, KeepsTheOldestAndCountsWhatHadNoRoom) {
  Ring<int, 4> ring;
  for (int i = 0; i < 6; ++i) EXPECT_EQ(ring.push(i), i < 4);
  EXPECT_EQ(ring.dropped(), 2U);
  int value = -1;
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.pop(value));
  EXPECT_TRUE(ring.push(7));
  ASSERT_TRUE(ring.pop(value));
  EXPECT_EQ(value, 7);
}

// Two threads, one of which is slow at times: what arrives is whole and in order, and with what was
// dropped it is all.
TEST(Ring, LosesNothingUncounted) {
  struct Wide {
    std::uint64_t number, copies[7];
  };
  constexpr std::uint64_t kCount = 300'000;
  Ring<Wide, 64> ring;
  std::uint64_t pushed = 0;
  std::atomic<bool> ends = false;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      if (ring.push({i, {i, i, i, i, i, i, i}})) ++pushed;
      if (i % 50 == 0) std::this_thread::yield();
    }
    ends = true;
  });
  std::uint64_t popped = 0, last = 0;
  Wide value{};
  for (bool was_ended = false; !was_ended;) {
    was_ended = ends;
    while (ring.pop(value)) {
      ++popped;
      ASSERT_GT(value.number, last);
      for (const std::uint64_t copy : value.copies) ASSERT_EQ(copy, value.number);
      last = value.number;
      if (popped % 1000 == 0) std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
  }
  writer.join();
  EXPECT_EQ(popped, pushed);
  EXPECT_EQ(popped + ring.dropped(), kCount);
}

TEST(LatencyHistogram, KnowsEachDurationToASixteenth) {
  std::minstd_rand random(1);
  for (int i = 0; i < 2000; ++i) {
    LatencyHistogram histogram;
    const auto duration_ns =
        static_cast<TimeNs>(std::exp(std::uniform_real_distribution<>(0, std::log(1e12))(random)));
    histogram.add(duration_ns);
    histogram.add(10 * duration_ns);  // so that the bin's end is not cut at the largest
    const TimeNs told_ns = histogram.quantile_ns(0.5);
    EXPECT_GE(told_ns, duration_ns);
    EXPECT_LE(told_ns, duration_ns + duration_ns / 16 + 1);
    EXPECT_EQ(histogram.largest_ns(), 10 * duration_ns);
  }
}

TEST(LatencyHistogram, HasAPlaceForEverything) {
  LatencyHistogram histogram;
  for (const TimeNs time_ns : {TimeNs{-5}, TimeNs{0}, std::numeric_limits<TimeNs>::max()}) {
    histogram.add(time_ns);
  }
  EXPECT_EQ(histogram.count(), 3U);
  EXPECT_EQ(histogram.in_bin(0), 2U);
  EXPECT_EQ(histogram.in_bin(LatencyHistogram::kBins - 1), 1U);
  EXPECT_EQ(LatencyHistogram().quantile_ns(0.5), 0);
}

}  // namespace
}  // namespace condyle::firmware
