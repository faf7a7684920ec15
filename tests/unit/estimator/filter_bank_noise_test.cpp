// SPDX-License-Identifier: Apache-2.0
// The limits of the noise that the bank estimates.
#include <gtest/gtest.h>

#include <cmath>

#include "condyle/estimator/motion/filter_bank.h"
#include "support/random.h"

namespace condyle {
namespace {

TEST(FilterBank, HoldsTheNoiseAboveThatOfRounding) {
  const double T = 0.01, lowest = 3e-5 * 3e-5;
  FilterBank<double, 1> bank(MotionEstimatorParameters{});
  bank.start_noise({5e-5});
  bank.start_motion({0}, 1);
  bank.hold_noise_above(0, lowest);
  for (int i = 0; i < 500; ++i) {
    bank.predict(white_jerk_jacobian(T), white_jerk_covariance(T));
    bank.learn({0}, T);
    ASSERT_TRUE(bank.update({0}, 1));
    ASSERT_GE(bank.noise_variance_m2(0), lowest * (1 - 1e-12));
  }
}

// A coordinate that does not change shows a step larger than the noise.
TEST(FilterBank, ARunOfOneValueTeachesNoNoise) {
  FilterBank<double, 1> bank(MotionEstimatorParameters{});
  bank.start_noise({5e-5});
  bank.start_motion({0}, 1);
  const auto take = [&bank] {
    bank.predict(white_jerk_jacobian(0.01), white_jerk_covariance(0.01));
    bank.learn({0.25}, 0.01);
    ASSERT_TRUE(bank.update({0.25}, 1));
  };
  for (int i = 0; i < 9; ++i) take();
  const double noise_m2 = bank.R(0, 9);
  for (int i = 0; i < 1000; ++i) take();
  EXPECT_EQ(bank.R(0, 9), noise_m2);
  EXPECT_FALSE(bank.noise_is_known());
}

// A sample that no member expects counts for the noise as one at huber's limit: in the mean of the
// squares of the samples in memory.
TEST(FilterBank, AnUnexpectedSampleTeachesTheNoiseByItsShare) {
  for (const double huber_sd : {2.0, 3.0}) {
    MotionEstimatorParameters parameters;
    parameters.noise.memory_s = 2;
    parameters.outliers.huber_sd = huber_sd;
    const double T = 0.01, samples = parameters.noise.memory_s / T;
    FilterBank<double, 1> bank(parameters);
    bank.start_noise({5e-5});
    bank.start_motion({0}, 1);
    testing_support::Random random(1);
    for (int i = 0; i < 2000; ++i) {
      bank.predict(white_jerk_jacobian(T), white_jerk_covariance(T));
      const double z = 5e-5 * random.normal();
      bank.learn({z}, T);
      ASSERT_TRUE(bank.update({z}, 1));
    }
    const double before_m2 = bank.noise_variance_m2(0);
    bank.predict(white_jerk_jacobian(T), white_jerk_covariance(T));
    bank.learn({1}, T);
    const double expected_m2 =
        ((samples - 1) * before_m2 + huber_sd * huber_sd * before_m2) / samples;
    EXPECT_NEAR(bank.noise_variance_m2(0) / expected_m2, 1, 1e-6);
  }
}

TEST(FilterBank, HoldsTheNoiseBetweenFloorAndCeiling) {
  MotionEstimatorParameters parameters;
  parameters.noise.lowest_position_sd_m = 2e-5;
  parameters.noise.highest_position_sd_m = 4e-4;
  for (const double guess : {1e-8, 2e-4, 0.1}) {
    for (const double swing_m : {0.0, 1e-4, 1.0}) {
      FilterBank<double, 1> bank(parameters);
      bank.start_noise({guess});
      bank.start_motion({0}, 1);
      for (int i = 0; i < 2000; ++i) {
        const double sd = std::sqrt(bank.noise_variance_m2(0));
        ASSERT_GE(sd, 2e-5 * (1 - 1e-12));
        ASSERT_LE(sd, 4e-4 * (1 + 1e-12));
        bank.predict(white_jerk_jacobian(0.01), white_jerk_covariance(0.01));
        const double z = (i % 3 == 0 ? swing_m : -swing_m) + (i % 2 == 0 ? 1e-9 : -1e-9);
        bank.learn({z}, 0.01);
        ASSERT_TRUE(bank.update({z}, 1));
      }
      EXPECT_EQ(bank.noise_is_at_limit(0), swing_m != 1e-4) << swing_m;
    }
  }
}

}  // namespace
}  // namespace condyle
