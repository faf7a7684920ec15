// SPDX-License-Identifier: Apache-2.0
#include "quality/step_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "quality/axis_ranges.h"

namespace condyle::host {
namespace {

using Point = std::array<double, 3>;

struct Instrument {
  double rate_Hz, noise_m, step_m, neighbour_correlation;
  // Whether this motion's steps stand out of noise and rounding enough to tell.
  bool shows_dropped, shows_held;
};

// Two minutes of a point that opens and closes, rests, and opens and closes again.
std::vector<Point> record(const Instrument& instrument, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const double start = 2 * std::numbers::pi * uniform(random), rhythm_Hz = 0.6 + uniform(random);
  const double c = instrument.neighbour_correlation;
  Point noise{};
  std::vector<Point> points;
  for (int i = 0; i < static_cast<int>(120 * instrument.rate_Hz); ++i) {
    const double t = i / instrument.rate_Hz;
    const double phase = start + 2 * std::numbers::pi * rhythm_Hz * t + std::sin(0.7 * t);
    const double height_m = 0.01 * std::clamp(2 * std::sin(0.3 * t + start), 0.0, 1.0);
    Point point = {0.05 + 0.4 * height_m * std::sin(phase), 0.002 * std::sin(0.11 * t),
                   -0.02 - height_m * (1 - std::cos(phase))};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      noise[axis] = c * noise[axis] + std::sqrt(1 - c * c) * normal(random);
      point[axis] += instrument.noise_m * noise[axis];
      if (instrument.step_m > 0) {
        point[axis] = std::round(point[axis] / instrument.step_m) * instrument.step_m;
      }
    }
    points.push_back(point);
  }
  return points;
}

constexpr Instrument kInstruments[] = {
    {60, 2e-5, 0, 0, true, true},       {60, 1e-4, 0, 0, false, true},
    {200, 1.5e-4, 0, 0, false, false},  {100, 5e-5, 0, 0.9, true, true},
    {100, 1e-6, 0, 0, true, true},      {60, 1e-5, 1e-4, 0, false, true},
    {200, 1e-6, 1e-4, 0, false, false}, {120, 0, 1.45e-4, 0, false, false},
    {50, 3e-5, 1e-5, 0, true, true}};

StepWatch watch(const std::vector<Point>& points, double rate_Hz) {
  StepWatch steps;
  for (std::size_t i = 0; i < points.size(); ++i) {
    steps.add(nanoseconds(static_cast<double>(i) / rate_Hz), points[i]);
  }
  return steps;
}

// 9 instruments, 20 recordings each: the rule allows 1e-6 for each of the two findings, so 4e-4 for
// the whole test.
TEST(StepWatch, FindsNothingWhereFramesAreEven) {
  for (const Instrument& instrument : kInstruments) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      const StepWatch steps = watch(record(instrument, seed), instrument.rate_Hz);
      EXPECT_FALSE(steps.has_dropped()) << instrument.rate_Hz << ' ' << seed << steps.dropped();
      EXPECT_FALSE(steps.has_held()) << instrument.rate_Hz << ' ' << seed << steps.held();
    }
  }
}

// One axis alone.
TEST(StepWatch, FindsNothingAlongOneAxisEither) {
  for (const Instrument& instrument : kInstruments) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      std::vector<Point> points = record(instrument, seed);
      for (Point& point : points) point = {point[2], 0, 0};
      const StepWatch steps = watch(points, instrument.rate_Hz);
      EXPECT_FALSE(steps.has_dropped()) << instrument.rate_Hz << ' ' << seed;
      EXPECT_FALSE(steps.has_held()) << instrument.rate_Hz << ' ' << seed;
    }
  }
}

TEST(StepWatch, FindsFramesDroppedUnderEvenTimes) {
  for (const Instrument& instrument : kInstruments) {
    const std::vector<Point> points = record(instrument, 1);
    std::vector<Point> left;
    std::uint64_t dropped = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i % 7 == 3) ++dropped;
      if (i % 7 != 3) left.push_back(points[i]);
    }
    const StepWatch steps = watch(left, instrument.rate_Hz);
    EXPECT_LE(steps.dropped(), dropped);
    EXPECT_FALSE(steps.has_held());
    EXPECT_EQ(steps.has_dropped(), instrument.shows_dropped)
        << instrument.rate_Hz << " Hz, " << instrument.noise_m << " m: " << steps.dropped();
  }
}

// Caught up with by the next frame, or not.
TEST(StepWatch, FindsPositionsHeldAmidMotion) {
  for (const bool catches_up : {true, false}) {
    for (const Instrument& instrument : kInstruments) {
      const std::vector<Point> points = record(instrument, 2);
      std::vector<Point> shown;
      std::uint64_t held = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const bool is_held = i % 11 == 5;
        held += is_held;
        if (is_held) shown.push_back(shown.back());
        if (!is_held || !catches_up) shown.push_back(points[i]);
      }
      const StepWatch steps = watch(shown, instrument.rate_Hz);
      EXPECT_LE(steps.held(), held);
      EXPECT_FALSE(steps.has_dropped());
      EXPECT_EQ(steps.has_held(), instrument.shows_held)
          << instrument.rate_Hz << " Hz, " << instrument.noise_m << " m: " << steps.held();
    }
  }
}

// A frame that is missing, and whose time is missing too, is a gap and nothing else.
TEST(StepWatch, TakesNoGapForADroppedFrame) {
  const std::vector<Point> points = record(kInstruments[0], 3);
  StepWatch gaps, missing;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TimeNs time_ns = nanoseconds(static_cast<double>(i) / kInstruments[0].rate_Hz);
    if (i % 9 != 4) gaps.add(time_ns, points[i]);
    if (i % 9 != 4) missing.add(time_ns, points[i]);
    if (i % 9 == 4) missing.add_missing();
  }
  EXPECT_EQ(gaps.dropped(), 0U);
  EXPECT_EQ(missing.dropped(), 0U);
}

TEST(AxisRanges, AreNotDecidedByGlitches) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform;
  for (const int count : {1, 2, 39, 4095, 4096, 5000, 100'000}) {
    AxisRanges ranges;
    for (int i = 0; i < count; ++i) {
      const double glitch_m = count > 100 && i % 50 == 7 ? 9.0 * (uniform(random) - 0.5) : 0.0;
      ranges.add({glitch_m + 0.02 * uniform(random), 0.5 + 0.001 * uniform(random), 3.0});
    }
    const auto ranges_m = ranges.ranges_m();
    EXPECT_EQ(ranges_m[2], 0) << count;
    EXPECT_LE(ranges_m[0], 0.02) << count;
    EXPECT_LE(ranges_m[1], 0.001) << count;
    if (count < 4000) continue;
    EXPECT_NEAR(ranges_m[0], 0.0192, 7e-4) << count << ": 1 % on either side may be glitches";
    EXPECT_NEAR(ranges_m[1], 0.00095, 2e-5) << count;
  }
  EXPECT_EQ(AxisRanges().ranges_m()[0], 0);
}

// A single position of a short recording is more than the share left out.
TEST(AxisRanges, OfAFewPositionsHoldAllOfThem) {
  AxisRanges ranges;
  for (int i = 1; i <= 40; ++i) {
    ranges.add({0.001 * i, 0, 0});
    EXPECT_NEAR(ranges.ranges_m()[0], 0.001 * (i - 1), 1e-12) << i;
  }
}

TEST(AxisRanges, NameTheAxisThatMoves) {
  EXPECT_EQ(livelier_axis({0.002, 0.03, 0.014}, 2, 2, 1e-3), 1U);
  EXPECT_EQ(livelier_axis({0.002, 0.027, 0.014}, 2, 2, 1e-3), 2U) << "both move";
  EXPECT_EQ(livelier_axis({0.03, 0.002, 0.014}, 0, 2, 1e-3), 0U);
  EXPECT_EQ(livelier_axis({9e-4, 1e-5, 0}, 2, 2, 1e-3), 2U) << "none moves";
}

}  // namespace
}  // namespace condyle::host
