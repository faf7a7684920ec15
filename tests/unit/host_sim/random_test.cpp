// SPDX-License-Identifier: Apache-2.0
// The generator against its published numbers, and its distributions. Seeds are fixed, so a test
// either always passes or always fails; each bound states how often a right generator under a
// random seed would exceed it.
#include "statistics/random.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

namespace condyle::host {
namespace {

using testing::ElementsAre;

// Known answers of the generator's authors (Random123, kat_vectors).
TEST(Random, PhiloxGivesItsPublishedBlocks) {
  EXPECT_THAT(philox_block({0, 0, 0, 0}, {0, 0}),
              ElementsAre(0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U));
  constexpr std::uint32_t ones = 0xffffffffU;
  EXPECT_THAT(philox_block({ones, ones, ones, ones}, {ones, ones}),
              ElementsAre(0x408f276dU, 0x41c83b0eU, 0xa20bc7c6U, 0x6d5451fdU));
  EXPECT_THAT(philox_block({0x243f6a88U, 0x85a308d3U, 0x13198a2eU, 0x03707344U},
                           {0xa4093822U, 0x299f31d0U}),
              ElementsAre(0xd16cfe09U, 0x94fdccebU, 0x5001e420U, 0x24126ea1U));
}

TEST(Random, FirstNumbersAreThoseOfTheFirstBlocks) {
  RandomGenerator zero(0);
  EXPECT_EQ(zero.next(), 0xe169c58d6627e8d5U);
  EXPECT_EQ(zero.next(), 0x9b00dbd8bc57ac4cU);

  const std::uint64_t seed = 0x0123456789abcdefU, stream = 0xfedcba9876543210U;
  RandomGenerator generator(seed, stream);
  for (std::uint32_t block = 0; block < 3; ++block) {
    const auto words =
        philox_block({block, 0, 0x76543210U, 0xfedcba98U}, {0x89abcdefU, 0x01234567U});
    EXPECT_EQ(generator.next(), std::uint64_t{words[1]} << 32U | words[0]);
    EXPECT_EQ(generator.next(), std::uint64_t{words[3]} << 32U | words[2]);
  }
}

// Recorded once: another machine or compiler setting that gives other bits fails here.
TEST(Random, NormalNumbersAreTheSameEverywhere) {
  RandomGenerator generator(7, 3);
  EXPECT_EQ(generator.normal(), -0x1.ef564107e0eddp-1);
  EXPECT_EQ(generator.normal(), 0x1.06bfd90e49974p-2);
  double sum = 0;
  for (int i = 0; i < 100'000; ++i) sum += generator.normal() * (i % 7);
  EXPECT_EQ(sum, 0x1.9da1f3267320ep+10);
}

constexpr int kCount = 1'000'000;

template <class Draw>
std::vector<double> draw(const Draw& one) {
  std::vector<double> values(kCount);
  for (double& value : values) value = one();
  return values;
}

double mean_power(const std::vector<double>& values, double centre, int power) {
  double sum = 0;
  for (const double value : values) sum += std::pow(value - centre, power);
  return sum / static_cast<double>(values.size());
}

// Largest distance of the distribution of `values` from `distribution`, times sqrt(n). A right
// generator exceeds 2.23 once in 10,000 seeds (Kolmogorov: 2 exp(-2 d^2)).
template <class Distribution>
double kolmogorov_distance(std::vector<double> values, const Distribution& distribution) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double largest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double expected = distribution(values[i]);
    largest = std::max({largest, expected - static_cast<double>(i) / n,
                        static_cast<double>(i + 1) / n - expected});
  }
  return largest * std::sqrt(n);
}

// Moments within 4 of their own standard deviations: exceeded once in 15,800 seeds each.
constexpr double kSigmas = 4;
const double kRootCount = std::sqrt(static_cast<double>(kCount));

TEST(Random, UniformNumbersAreUniform) {
  RandomGenerator generator(1);
  const auto values = draw([&] { return generator.uniform(); });
  EXPECT_GE(*std::min_element(values.begin(), values.end()), 0);
  EXPECT_LT(*std::max_element(values.begin(), values.end()), 1);
  EXPECT_NEAR(mean_power(values, 0, 1), 0.5, kSigmas * std::sqrt(1.0 / 12) / kRootCount);
  EXPECT_NEAR(mean_power(values, 0.5, 2), 1.0 / 12, kSigmas * std::sqrt(1.0 / 180) / kRootCount);
  EXPECT_LT(kolmogorov_distance(values, [](double x) { return x; }), 2.23);
}

TEST(Random, NormalNumbersAreNormal) {
  RandomGenerator generator(2);
  const auto values = draw([&] { return generator.normal(); });
  EXPECT_NEAR(mean_power(values, 0, 1), 0, kSigmas / kRootCount);
  EXPECT_NEAR(mean_power(values, 0, 2), 1, kSigmas * std::sqrt(2.0) / kRootCount);
  EXPECT_NEAR(mean_power(values, 0, 3), 0, kSigmas * std::sqrt(15.0) / kRootCount);
  EXPECT_NEAR(mean_power(values, 0, 4), 3, kSigmas * std::sqrt(96.0) / kRootCount);
  const auto distribution = [](double x) { return std::erfc(-x / std::sqrt(2.0)) / 2; };
  EXPECT_LT(kolmogorov_distance(values, distribution), 2.23);
  // The tails, which a sum of twelve uniform numbers misses: Poisson, 4 sd.
  const auto beyond = static_cast<double>(
      std::count_if(values.begin(), values.end(), [](double x) { return std::abs(x) > 4; }));
  const double expected = kCount * 2 * distribution(-4);
  EXPECT_NEAR(beyond, expected, kSigmas * std::sqrt(expected));
}

TEST(Random, EveryBitIsFair) {
  RandomGenerator generator(3);
  std::array<int, 64> ones = {};
  for (int i = 0; i < kCount; ++i) {
    const std::uint64_t bits = generator.next();
    for (unsigned k = 0; k < 64; ++k) ones[k] += static_cast<int>(bits >> k & 1U);
  }
  double chi_square = 0;  // 64 degrees of freedom; outside once in 5,600 seeds
  for (const int count : ones) chi_square += std::pow((count - kCount / 2.0) / (kRootCount / 2), 2);
  EXPECT_LT(chi_square, 113);
  EXPECT_GT(chi_square, 28);
}

// Correlation of normal numbers, times sqrt(n): standard normal for independent ones.
double correlation(RandomGenerator a, RandomGenerator b, int lag) {
  for (int i = 0; i < lag; ++i) static_cast<void>(b.normal());
  double sum = 0;
  constexpr int count = 100'000;
  for (int i = 0; i < count; ++i) sum += a.normal() * b.normal();
  return sum / std::sqrt(static_cast<double>(count));
}

TEST(Random, StreamsAndSeedsAreIndependent) {
  const RandomGenerator reference(5, 0);
  double chi_square = 0;
  int terms = 0;
  for (const std::uint64_t other : {1ULL, 2ULL, 3ULL, 0x100000000ULL, 0x8000000000000000ULL}) {
    for (const int lag : {0, 1, 2, 5}) {
      chi_square += std::pow(correlation(reference, RandomGenerator(5, other), lag), 2);
      chi_square += std::pow(correlation(reference, RandomGenerator(5 + other, 0), lag), 2);
      terms += 2;
    }
  }
  for (int lag = 1; lag <= 10; ++lag) {  // within one stream
    chi_square += std::pow(correlation(reference, reference, lag), 2);
    ++terms;
  }
  // 50 degrees of freedom: outside once in 2,400 seeds.
  ASSERT_EQ(terms, 50);
  EXPECT_LT(chi_square, 93);
  EXPECT_GT(chi_square, 22);
}

TEST(Random, StreamsShareNoNumbers) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t stream = 0; stream < 100; ++stream) {
    RandomGenerator generator(6, stream);
    for (int i = 0; i < 1000; ++i) EXPECT_TRUE(seen.insert(generator.next()).second);
  }
}

}  // namespace
}  // namespace condyle::host
