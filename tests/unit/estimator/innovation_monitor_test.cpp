// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/math/innovation_monitor.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace condyle {
namespace {

template <class Scalar>
class Monitor : public testing::Test {
 protected:
  static constexpr double kStep_s = 0.005;

  // White noise, smoothed over `n` neighbours, on a 1.2 Hz motion of 8 mm.
  std::vector<double> positions(int n, std::size_t count, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> noise(0, 5e-5);
    std::vector<double> recent(static_cast<std::size_t>(n)), result;
    for (std::size_t i = 0; i < count; ++i) {
      recent[i % recent.size()] = noise(generator);
      double sum = 0;
      for (const double value : recent) sum += value;
      result.push_back(0.008 * std::sin(7.54 * kStep_s * static_cast<double>(i)) + sum / n);
    }
    return result;
  }
  InnovationMonitor<Scalar> watch(const std::vector<double>& positions) {
    InnovationMonitor<Scalar> monitor;
    for (const double position : positions) {
      monitor.add(Scalar(0.1), static_cast<Scalar>(position), Scalar(kStep_s));
    }
    return monitor;
  }
};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Monitor, Scalars);

// 500 runs of 300 samples: none may be called filtered. Five standard deviations of chance at each
// of 32 distances: false alarm of the whole test 500 * 32 * 5.7e-7 = 0.01 at most, as the margins
// add to them.
TYPED_TEST(Monitor, KnowsWhiteNoise) {
  double sum = 0, square_sum = 0;
  for (unsigned seed = 0; seed < 500; ++seed) {
    const auto monitor = this->watch(this->positions(1, 300, seed));
    EXPECT_FALSE(monitor.is_filtered()) << seed;
    const auto value = static_cast<double>(monitor.noise_correlation());
    sum += value;
    square_sum += value * value;
  }
  EXPECT_NEAR(sum / 500, -6.0 / 7, 0.01);
  EXPECT_LT(std::sqrt(square_sum / 500 - sum / 500 * sum / 500), 0.32 / std::sqrt(294.0) * 1.1);
}

TYPED_TEST(Monitor, SaysNothingFromFewSamples) {
  EXPECT_FALSE(this->watch(this->positions(20, 200, 1)).is_filtered());
  EXPECT_FALSE(InnovationMonitor<TypeParam>().is_correlated());
}

// The commonest filter of all. It leaves zeros in the spectrum, which no difference lifts.
TYPED_TEST(Monitor, KnowsAMeanOverNeighbours) {
  for (int n = 2; n <= NoiseColour<TypeParam>::kMostLags; ++n) {
    const auto monitor = this->watch(this->positions(n, 2000, static_cast<unsigned>(n)));
    EXPECT_TRUE(monitor.is_filtered()) << n;
    if (n <= 6) continue;
    EXPECT_EQ(monitor.filtered_lag(), n);
    EXPECT_NEAR(static_cast<double>(monitor.noise_correlation(n)), -0.5, 0.2) << n;
  }
}

TYPED_TEST(Monitor, IsNotMisledByGlitchesAtTheStart) {
  for (const double glitch_m : {0.02, 1.0, 1e3, 1e30}) {
    for (const std::size_t at : {0U, 3U, 9U}) {
      std::vector<double> positions = this->positions(1, 2000, 3);
      positions[at] += glitch_m;
      EXPECT_FALSE(this->watch(positions).is_filtered()) << glitch_m << " at " << at;
    }
  }
}

// What is usual among the first differences is their median: glitches in less than half of them do
// not make it.
TYPED_TEST(Monitor, IsNotMisledByGlitchesAnywhereAmongTheFirst) {
  for (std::size_t at = 0; at < 54; ++at) {
    std::vector<double> positions = this->positions(1, 300, 4);
    const auto expected = this->watch(positions).noise_correlation();
    for (std::size_t i = at; i < 54; i += 20) positions[i] += 1.0 + 0.1 * static_cast<double>(i);
    const auto monitor = this->watch(positions);
    EXPECT_NEAR(monitor.noise_correlation(), expected, 0.1) << at;
    EXPECT_FALSE(monitor.is_filtered()) << at;
  }
}

TYPED_TEST(Monitor, KnowsNoiseThatDrifts) {
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0, 1e-5);
  std::vector<double> positions;
  double slow = 0, slower = 0;
  for (int i = 0; i < 2000; ++i) {
    slow += 0.2 * (noise(generator) - slow);
    slower += 0.2 * (slow - slower);
    positions.push_back(slower);
  }
  const auto monitor = this->watch(positions);
  EXPECT_TRUE(monitor.is_filtered()) << monitor.noise_correlation();
}

TYPED_TEST(Monitor, IsNotMisledByGlitchesGapsAndMissingPositions) {
  std::vector<double> positions = this->positions(1, 4000, 2);
  InnovationMonitor<TypeParam> monitor;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    // Of the glitches most are rejected, and so not shown to it.
    if (i % 97 == 5) positions[i] += i % 5 == 0 ? 0.005 : std::numeric_limits<double>::quiet_NaN();
    if (i % 61 == 7) positions[i] = std::numeric_limits<double>::quiet_NaN();
    monitor.add(TypeParam(0.1), static_cast<TypeParam>(positions[i]),
                static_cast<TypeParam>(i % 41 == 3 ? 0.02 : 0.005));
  }
  EXPECT_FALSE(monitor.is_filtered()) << monitor.noise_correlation();
}

// What a gap parts is no pair.
TYPED_TEST(Monitor, PairsNothingAcrossAGap) {
  Autocorrelation<TypeParam, 2> correlation;
  correlation.add(1);
  correlation.add(std::numeric_limits<TypeParam>::quiet_NaN());
  correlation.add(1);
  EXPECT_EQ(correlation.pairs(1), TypeParam(0));
  correlation.add(1);
  EXPECT_EQ(correlation.pairs(1), TypeParam(1));
  EXPECT_EQ(correlation.pairs(2), TypeParam(0));
}

// rho of n white innovations scatters by 1/sqrt(n): 400 runs of 1000, the largest of which stays
// below 0.1267 (four standard deviations) with probability 0.987.
TYPED_TEST(Monitor, KnowsCorrelatedInnovations) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    InnovationMonitor<TypeParam> white, correlated;
    double carried = 0;
    for (int i = 0; i < 1000; ++i) {
      const double e = normal(generator);
      carried = 0.4 * carried + std::sqrt(1 - 0.16) * e;
      const bool is_glitch = i % 100 == 50;
      white.add(static_cast<TypeParam>(is_glitch ? 40 : e), 0, TypeParam(0.01));
      correlated.add(static_cast<TypeParam>(carried), 0, TypeParam(0.01));
    }
    EXPECT_FALSE(white.is_correlated()) << seed;
    EXPECT_TRUE(correlated.is_correlated()) << seed;
    EXPECT_NEAR(static_cast<double>(correlated.innovation_correlation()), 0.4, 0.17);
    EXPECT_NEAR(static_cast<double>(correlated.mean_nis()), 1, 0.4);
  }
}

}  // namespace
}  // namespace condyle
