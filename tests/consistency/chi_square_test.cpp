// SPDX-License-Identifier: Apache-2.0
// Against printed tables: Abramowitz and Stegun 26.1, 26.8 and 26.10, and the definitions.
#include "statistics/chi_square.h"

#include <gtest/gtest.h>

#include <cmath>

namespace condyle::host {
namespace {

TEST(ChiSquare, QuantilesAreThoseOfTheTable) {
  const struct {
    double probability, degrees_of_freedom, x;
  } table[] = {{0.95, 1, 3.841},   {0.975, 1, 5.024},    {0.025, 10, 3.247}, {0.95, 10, 18.307},
               {0.05, 30, 18.493}, {0.99, 100, 135.807}, {0.999, 3, 16.266}};
  for (const auto& row : table) {
    const double x = chi_square_quantile(row.probability, row.degrees_of_freedom);
    EXPECT_NEAR(x, row.x, 5e-4);
    EXPECT_NEAR(chi_square_distribution(x, row.degrees_of_freedom), row.probability, 1e-13);
  }
}

TEST(ChiSquare, NormalAndStudentQuantilesAreThoseOfTheTable) {
  EXPECT_NEAR(normal_distribution(1), 0.8413447460685429, 1e-15);
  EXPECT_NEAR(normal_quantile(0.995), 2.5758293035489, 1e-12);
  EXPECT_NEAR(student_t_quantile(0.975, 10), 2.228, 5e-4);
  EXPECT_NEAR(student_t_quantile(0.95, 1), 6.314, 5e-4);
}

TEST(ChiSquare, BoundsOfAMeanAreThoseOfTheSum) {
  const Interval bounds = mean_chi_square_bounds(2, 50, 0.95);  // 100 degrees of freedom
  EXPECT_NEAR(bounds.low, 74.222 / 50, 1e-5);
  EXPECT_NEAR(bounds.high, 129.561 / 50, 1e-5);
  EXPECT_TRUE(mean_chi_square_bounds(2, 0, 0.95).contains(1e300));
  EXPECT_FALSE(bounds.contains(std::nan("")));
}

TEST(ChiSquare, IntervalOfAProportionIsThatOfTheTable) {
  const struct {
    double hits, low, high;
  } of_ten[] = {{0, 0, 0.3085}, {1, 0.0025, 0.4450}, {5, 0.1871, 0.8129}, {10, 0.6915, 1}};
  for (const auto& row : of_ten) {
    const Interval interval = proportion_interval(row.hits, 10, 0.95);
    EXPECT_NEAR(interval.low, row.low, 5e-5);
    EXPECT_NEAR(interval.high, row.high, 5e-5);
  }
  EXPECT_EQ(proportion_interval(0, 0, 0.95).high, 1);
}

TEST(ChiSquare, RefusesWhatIsNoProbability) {
  EXPECT_THROW(chi_square_quantile(-0.1, 1), std::domain_error);
  EXPECT_THROW(chi_square_quantile(0.5, -1), std::domain_error);
  EXPECT_THROW(normal_quantile(std::nan("")), std::domain_error);
}

}  // namespace
}  // namespace condyle::host
