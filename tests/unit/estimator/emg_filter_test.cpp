// SPDX-License-Identifier: Apache-2.0
// What the filter of a point driven by muscles knows before the first sample.
#include <gtest/gtest.h>

#include <cmath>

#include "condyle/estimator/emg/emg_identification.h"

namespace condyle {
namespace {

EmgParameters uneven() {
  EmgParameters parameters;
  parameters.mass_kg = {0.2, 0.06};
  parameters.friction_Ns_m = {1.5, 2};
  parameters.stiffness_N_m = {30, 20};
  parameters.offset_N = {-0.4, 0.3};
  parameters.gain = {0.9, 0.5};
  return parameters;
}

// State and covariance.
class OpenFilter : public EmgFilter<double> {
 public:
  using EmgFilter::EmgFilter;
  double value(int i) const { return x()[lambda + i]; }
  double covariance(int i, int j) const { return P()(lambda + i, lambda + j); }
};

TEST(EmgFilter, BeginsWithThePriors) {
  const EmgParameters parameters = uneven();
  const auto estimate = EmgIdentification<double>(parameters, 2).estimate();
  EXPECT_NEAR(estimate.friction_Ns_m.fitted, parameters.friction_Ns_m.mean, 1e-12);
  EXPECT_NEAR(estimate.stiffness_N_m.fitted, parameters.stiffness_N_m.mean, 1e-12);
  EXPECT_NEAR(estimate.offset_N.fitted, parameters.offset_N.mean, 1e-12);
  for (const std::size_t n : {0U, 1U}) {
    EXPECT_NEAR(estimate.gain[n].fitted, parameters.gain.mean, 1e-12);
  }
  EXPECT_EQ(estimate.friction_Ns_m.limit, EmgLimit::no_emg);
}

// Means over all signs of one standard deviation of each prior and of 1 / m, which all products of
// independent quantities share with any distribution of the same mean and variance.
TEST(EmgFilter, BeginsWithTheCovarianceOfValuesPerMass) {
  const EmgParameters parameters = uneven();
  const OpenFilter filter(parameters, 1);
  const EmgPrior priors[] = {parameters.friction_Ns_m, parameters.stiffness_N_m,
                             parameters.offset_N, parameters.gain};
  const double e = 1 / parameters.mass_kg.mean, e_sd = e * e * parameters.mass_kg.sd;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      double mean_i = 0, mean_j = 0, product = 0;
      for (int signs = 0; signs < 8; ++signs) {
        const auto sign = [signs](int bit) { return (signs >> bit & 1) != 0 ? 1 : -1; };
        const double per_kg = e + sign(0) * e_sd;
        const double of_i = (priors[i].mean + sign(1) * priors[i].sd) * per_kg;
        const double of_j = (priors[j].mean + sign(i == j ? 1 : 2) * priors[j].sd) * per_kg;
        mean_i += of_i / 8;
        mean_j += of_j / 8;
        product += of_i * of_j / 8;
      }
      EXPECT_NEAR(filter.value(i), mean_i, 1e-9 * std::abs(mean_i));
      EXPECT_NEAR(filter.covariance(i, j), product - mean_i * mean_j, 1e-9 * std::abs(product));
    }
  }
}

}  // namespace
}  // namespace condyle
