// SPDX-License-Identifier: Apache-2.0
// The noise of a smooth signal, and whether it is white, from the signal itself.
#include "condyle/estimator/impedance/noise_difference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace condyle {
namespace {

struct Sums {
  NoiseSums<double> noise;
  NoiseLagSums<double> lags{};
};

TEST(NoiseDifference, IsZeroForAPolynomialOfTheFifthDegree) {
  NoiseDifference<double> difference(0.01);
  Sums sums;
  for (const int time : {0, 7, 20, 31, 38, 52, 60, 75}) {
    const double t = time * 1e-3;
    const double value = 1 + t * (2 - t * (3 + t * (4 - t * (5 + 6 * t))));
    difference.add(nanoseconds(t), value, sums.noise, sums.lags);
    EXPECT_EQ(sums.noise.count, time < 60 ? 0 : time < 75 ? 1 : 2);  // seven samples
  }
  EXPECT_NEAR(sums.noise.variance, 0, 1e-24);
}

TEST(NoiseDifference, SaysNothingAcrossAGapOrOfOneInstant) {
  NoiseDifference<double> difference(0.01);
  Sums sums;
  const auto add = [&](TimeNs time_ns) {
    difference.add(time_ns, static_cast<double>(time_ns % 7), sums.noise, sums.lags);
    return sums.noise.count;
  };
  for (TimeNs k = 0; k < 7; ++k) add(k * 10'000'000);
  EXPECT_EQ(add(200'000'000), 1);
  difference.interrupt();
  for (TimeNs k = 0; k < 6; ++k) EXPECT_EQ(add(k * 10'000'000), 1);
  EXPECT_EQ(add(60'000'000), 2);
  EXPECT_EQ(add(60'000'000), 2);
  for (const double sum : sums.lags) EXPECT_EQ(sum, 0);  // never two in a row
}

// What the sums say of white noise of which means of `taps` samples are taken, on a motion, in
// units of its variance; the lags in units of what they show for the variance.
Sums seen(int taps, double jitter_s, bool has_heavy_tails = false) {
  constexpr double kStep_s = 1.0 / 60, kNoise_m = 5e-5;
  constexpr int kSamples = 20000;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, kNoise_m);
  std::student_t_distribution<double> heavy(4);  // of variance 2
  std::uniform_real_distribution<double> jitter(-jitter_s, jitter_s);
  std::vector<double> raw(kSamples);
  for (double& value : raw) {
    value = has_heavy_tails ? heavy(random) * kNoise_m / std::sqrt(2) : normal(random);
  }
  NoiseDifference<double> difference(kStep_s);
  Sums sums;
  for (int k = taps; k < kSamples; ++k) {
    const double t = k * kStep_s + jitter(random);
    double value = 0.0075 * std::sin(8 * t);
    for (int tap = 0; tap < taps; ++tap) value += raw[static_cast<std::size_t>(k - tap)] / taps;
    difference.add(nanoseconds(t), value, sums.noise, sums.lags);
  }
  for (double& sum : sums.lags) sum /= sums.noise.variance;
  sums.noise.variance /= sums.noise.count * kNoise_m * kNoise_m;
  return sums;
}

// A mean of 20000 neighbouring, correlated products strays by 2 %, with heavy tails by 3 %; the
// bounds are 3.3 of that and more.
TEST(NoiseDifference, FindsWhiteNoiseWhiteAtEvenAndUnevenTimes) {
  for (const double jitter_s : {0.0, 3e-3}) {
    for (const bool has_heavy_tails : {false, true}) {
      const Sums white = seen(1, jitter_s, has_heavy_tails);
      EXPECT_NEAR(white.noise.variance, 1, 0.1) << jitter_s;
      for (const double lag : white.lags) EXPECT_NEAR(lag, 0, 0.08) << jitter_s;
    }
  }
}

TEST(NoiseDifference, FindsMeansOfSomeSamplesNotWhite) {
  for (int taps = 2; taps <= static_cast<int>(kNoiseLags); ++taps) {
    const Sums smooth = seen(taps, 0);
    const auto farthest =
        std::max_element(smooth.lags.begin(), smooth.lags.end(),
                         [](double a, double b) { return std::abs(a) < std::abs(b); });
    EXPECT_GT(std::abs(*farthest), 0.2) << taps;
    EXPECT_LT(smooth.lags[static_cast<std::size_t>(taps - 1)], -0.1) << taps;
  }
}

}  // namespace
}  // namespace condyle
