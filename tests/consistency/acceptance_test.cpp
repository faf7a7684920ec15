// SPDX-License-Identifier: Apache-2.0
// Against sums of the binomial distribution and printed quantiles.
#include "support/acceptance.h"

#include <gtest/gtest.h>

namespace condyle::testing_support {
namespace {

// Of `trials`, at most `hits`.
double probability_of_at_most(std::uint64_t hits, std::uint64_t trials, double probability) {
  double sum = 0, ways = 1;
  for (std::uint64_t k = 0; k <= hits; ++k) {
    sum += ways * std::pow(probability, k) * std::pow(1 - probability, trials - k);
    ways *= static_cast<double>(trials - k) / static_cast<double>(k + 1);
  }
  return sum;
}

TEST(Acceptance, OneHitFewerIsAFalseAlarm) {
  for (const std::uint64_t trials : {8U, 40U, 200U}) {
    for (const double probability : {0.5, 0.95}) {
      const std::uint64_t fewest = fewest_hits(trials, probability, 0.01);
      ASSERT_GT(fewest, 0U);
      EXPECT_LE(probability_of_at_most(fewest - 1, trials, probability), 0.01);
      EXPECT_GT(probability_of_at_most(fewest, trials, probability), 0.01);
      EXPECT_EQ(most_hits(trials, 1 - probability, 0.01), trials - fewest);
    }
  }
}

TEST(Acceptance, TooFewTrialsTellNothing) {
  EXPECT_EQ(fewest_hits(1, 0.95, 0.04), 0U);
  EXPECT_EQ(most_hits(1, 0.05, 0.04), 1U);
  EXPECT_EQ(fewest_hits(1, 0.95, 0.06), 1U) << "one miss in twenty is rarer than that";
}

// Chi-square of 10 at 0.99 and the normal quantile at 0.995, of the tables.
TEST(Acceptance, RmsAndMeanAreThoseOfNormalErrors) {
  EXPECT_NEAR(most_rms_ratio(10, 0.01), std::sqrt(23.2093 / 10), 1e-5);
  EXPECT_NEAR(most_mean_ratio(25, 0.01), 2.575829 / 5, 1e-6);
}

}  // namespace
}  // namespace condyle::testing_support
