// SPDX-License-Identifier: Apache-2.0
// Cycles are counted right, and pauses are none.
#include "condyle/estimator/changes/cycle_segmentation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/random.h"

namespace condyle {
namespace {

struct Counts {
  int begins = 0, ends = 0;
};

// `cycles` times 15 mm at `cycle_Hz`, after each a pause, as a filter at 60 Hz would see them.
Counts chew(CycleSegmentation<double>& cutter, double cycle_Hz, int cycles, double pause_s,
            std::uint64_t seed) {
  testing_support::Random random(seed);
  Counts counts;
  const double T = 1.0 / 60, w = 2 * std::numbers::pi * cycle_Hz;
  const auto add = [&](double p, double v) {
    const CyclePlace place = cutter.add(p + 3e-5 * random.normal(), v + 2e-3 * random.normal());
    counts.begins += place == CyclePlace::begin ? 1 : 0;
    counts.ends += place == CyclePlace::end ? 1 : 0;
  };
  for (double t = 0; t < 1; t += T) add(0, 0);
  for (int cycle = 0; cycle < cycles; ++cycle) {
    for (double t = 0; t < 1 / cycle_Hz; t += T) {
      add(0.0075 * (1 - std::cos(w * t)), 0.0075 * w * std::sin(w * t));
    }
    for (double t = 0; t < pause_s; t += T) add(0, 0);
  }
  for (double t = 0; t < 1; t += T) add(0, 0);
  return counts;
}

TEST(CycleSegmentation, CountsCyclesAtAnyRateWithAndWithoutPauses) {
  std::uint64_t seed = 0;
  for (const double cycle_Hz : {0.65, 0.9, 1.3, 1.6}) {
    for (const double pause_s : {0.0, 0.3, 2.0}) {
      CycleSegmentation<double> cutter(0.002);
      EXPECT_EQ(chew(cutter, cycle_Hz, 40, pause_s, ++seed).ends, 40) << cycle_Hz << ' ' << pause_s;
    }
  }
}

TEST(CycleSegmentation, NoiseAndSmallMovementsAreNoCycles) {
  testing_support::Random random(1);
  CycleSegmentation<double> cutter(0.002);
  for (int i = 0; i < 10000; ++i) {
    const double phase = 0.1 * i;
    EXPECT_NE(cutter.add(0.0009 * std::sin(phase) + 3e-5 * random.normal(), std::cos(phase)),
              CyclePlace::end);
  }
}

// A halt on the way down divides the cycle in none.
TEST(CycleSegmentation, AHaltWhileItRisesDoesNotEndACycle) {
  CycleSegmentation<double> cutter(0.002);
  EXPECT_EQ(cutter.add(0, -1), CyclePlace::outside);
  EXPECT_EQ(cutter.add(0, 1), CyclePlace::begin);
  EXPECT_EQ(cutter.add(0.005, 1), CyclePlace::within);
  EXPECT_EQ(cutter.add(0.0045, -1), CyclePlace::within);
  EXPECT_EQ(cutter.add(0.005, 1), CyclePlace::within);
  EXPECT_EQ(cutter.add(0.010, 1), CyclePlace::within);
  EXPECT_EQ(cutter.add(0.001, -1), CyclePlace::within);
  EXPECT_EQ(cutter.add(0.001, 1), CyclePlace::end);
  EXPECT_EQ(cutter.add(0.0015, -1), CyclePlace::within);
  EXPECT_EQ(cutter.add(0.0015, 1), CyclePlace::begin) << "nothing but a pause until here";
  cutter.reset();
  EXPECT_EQ(cutter.add(0.005, 1), CyclePlace::outside);
}

}  // namespace
}  // namespace condyle
