// SPDX-License-Identifier: Apache-2.0
// The noise of a smooth signal, and whether it is white, from the signal itself.
#include "condyle/estimator/noise_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace condyle {
namespace {

using Sixth = NoiseDifference<double, 6>;

TEST(NoiseDifference, IsZeroForAPolynomialOfALowerDegree) {
  Sixth difference(0.01);
  const int times[] = {0, 7, 20, 31, 38, 52, 60, 75};
  for (const int time : times) {
    const double t = time * 1e-3;
    const double value = 1 + t * (2 - t * (3 + t * (4 - t * (5 + 6 * t))));
    EXPECT_EQ(difference.add(nanoseconds(t), value), time >= 60);  // seven samples
    if (time >= 60) {
      EXPECT_NEAR(difference.value(), 0, 1e-12);
    }
  }
}

TEST(NoiseDifference, KnowsTheCorrelationOfNeighboursAtEvenSteps) {
  Sixth difference(0.01);
  for (TimeNs k = 0; k < 9; ++k) (void)difference.add(k * 10'000'000, 0);
  ASSERT_TRUE(difference.has_before());
  EXPECT_NEAR(difference.correlation(), -6.0 / 7, 1e-12);
}

TEST(NoiseDifference, SaysNothingAcrossAGapOrOfOneInstant) {
  Sixth difference(0.01);
  for (TimeNs k = 0; k < 7; ++k) (void)difference.add(k * 10'000'000, 0);
  EXPECT_FALSE(difference.add(200'000'000, 0));
  difference.interrupt();
  for (TimeNs k = 0; k < 6; ++k) EXPECT_FALSE(difference.add(k * 10'000'000, 0));
  EXPECT_TRUE(difference.add(60'000'000, 6));
  EXPECT_FALSE(difference.has_before());
  EXPECT_FALSE(difference.add(60'000'000, 6));
}

// Means over the samples of the sums, in units of the variance of the samples' noise.
struct Seen {
  double variance = 0, neighbours = 0, apart = 0;
};

// A motion of 1.3 Hz, white noise before and after a mean of `taps` samples, stamps that stray.
Seen seen(int taps, double jitter_s, double after_m) {
  constexpr double kStep_s = 1.0 / 60, kNoise_m = 5e-5;
  constexpr int kSamples = 20000;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, kNoise_m), later(0, after_m);
  std::uniform_real_distribution<double> jitter(-jitter_s, jitter_s);
  std::vector<double> raw(kSamples);
  for (double& value : raw) value = noise(random);
  NoiseObserver<double> observer(kStep_s);
  NoiseSums<double> sums;
  for (int k = taps; k < kSamples; ++k) {
    const double t = k * kStep_s + jitter(random);
    double value = 0.0075 * std::sin(8 * t) + later(random);
    for (int tap = 0; tap < taps; ++tap) {
      value += raw[static_cast<std::size_t>(k - tap)] / taps;
    }
    observer.add(nanoseconds(t), value, sums);
  }
  const double unit = sums.count * kNoise_m * kNoise_m;
  return {sums.variance / unit, sums.neighbours / unit, sums.apart / unit};
}

// One mean of the squares of 20000 differences strays by 2 %, as neighbours are correlated; the
// bounds are 3.3 of that and more.
TEST(NoiseObserver, FindsWhiteNoiseWhiteAtEvenAndUnevenTimes) {
  for (const double jitter_s : {0.0, 3e-3}) {
    const Seen white = seen(1, jitter_s, 0);
    EXPECT_NEAR(white.variance, 1, 0.08) << jitter_s;
    EXPECT_NEAR(white.neighbours, 0, 0.01) << jitter_s;
    EXPECT_NEAR(white.apart, 0, 0.1) << jitter_s;
  }
}

TEST(NoiseObserver, FindsMeansOfSomeSamplesNotWhite) {
  for (const int taps : {2, 3, 4, 5, 6, 7, 9, 12}) {
    const Seen smooth = seen(taps, 0, 0);
    const double neighbours = std::abs(smooth.neighbours) / smooth.variance,
                 apart = std::abs(smooth.apart) / smooth.variance;
    EXPECT_TRUE(neighbours > 0.03 || apart > 0.3) << taps << ' ' << neighbours << ' ' << apart;
  }
}

}  // namespace
}  // namespace condyle
