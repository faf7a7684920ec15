// SPDX-License-Identifier: Apache-2.0
// The noise of a smooth signal, from the signal itself.
#include "condyle/estimator/sixth_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace condyle {
namespace {

TEST(SixthDifference, FindsTheNoiseOnAMotionAtUnevenTimes) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 5e-5);
  std::uniform_real_distribution<double> jitter(-3e-3, 3e-3);
  SixthDifference<double> difference(1.0 / 60, 0.2);
  double sum = 0;
  int count = 0;
  for (int k = 0; k < 20000; ++k) {
    const double t = k / 60.0 + jitter(random);
    const double variance =
        difference.add(nanoseconds(t), 0.0075 * std::sin(8 * t) + noise(random));
    if (variance < 0) continue;
    sum += variance;
    ++count;
  }
  EXPECT_EQ(count, 20000 - 6);
  EXPECT_NEAR(std::sqrt(sum / count) / 5e-5, 1, 0.04);  // 3.3 standard deviations
}

TEST(SixthDifference, IsZeroForAPolynomialOfTheFifthDegree) {
  SixthDifference<double> difference(0.01, 1);
  const int times[] = {0, 7, 20, 31, 38, 52, 60, 75};
  for (const int time : times) {
    const double t = time * 1e-3;
    const double value = 1 + t * (2 - t * (3 + t * (4 - t * (5 + 6 * t))));
    const double variance = difference.add(nanoseconds(t), value);
    if (time < 60) {
      EXPECT_LT(variance, 0);  // six samples and less
    } else {
      EXPECT_NEAR(variance, 0, 1e-24);
    }
  }
}

TEST(SixthDifference, SaysNothingAcrossAGapOrOfOneInstant) {
  SixthDifference<double> difference(0.01, 0.085);
  for (int k = 0; k < 7; ++k) (void)difference.add(k * 10'000'000, k);
  EXPECT_LT(difference.add(200'000'000, 0), 0);
  difference.interrupt();
  for (int k = 0; k < 6; ++k) EXPECT_LT(difference.add(k * 10'000'000, k), 0);
  EXPECT_GE(difference.add(60'000'000, 6), 0);
  EXPECT_LT(difference.add(60'000'000, 6), 0);
}

}  // namespace
}  // namespace condyle
