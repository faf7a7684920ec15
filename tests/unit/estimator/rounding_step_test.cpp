// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/motion/rounding_step.h"

#include "support/random.h"
#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;
using testing_support::Random;

double course_m(int i) {
  return 0.3 + 0.01 * std::sin(0.05 * i) + 0.002 * std::sin(0.31 * i);
}

// Found, whatever the step and the speed; kept through stray samples.
template <class Scalar>
void expect_found(double step_m, double noise_m, double stray_share, std::uint64_t seed) {
  RoundingStep<Scalar> rounding;
  Random random(seed);
  for (int i = 0; i < 600; ++i) {
    const double z = course_m(i) + noise_m * random.normal();
    const bool is_stray = i > 200 && random.uniform() < stray_share;
    rounding.add(static_cast<Scalar>(is_stray ? z : step_m * std::round(z / step_m)));
    if (i == 200 || i == 599) {
      RC_ASSERT(std::abs(static_cast<double>(rounding.step_m()) / step_m - 1) < 0.02);
    }
  }
}

RC_GTEST_PROP(RoundingStep, IsFound, ()) {
  const double step_m = std::pow(10, *number_between(-5, -3.3));
  const double noise_m = step_m * *number_between(0, 3);
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  expect_found<double>(step_m, noise_m, 0.02, seed);
}

RC_GTEST_PROP(RoundingStep, IsFoundInFloat, ()) {
  const double step_m = std::pow(10, *number_between(-3.8, -3.3));
  const double noise_m = step_m * *number_between(0, 3);
  expect_found<float>(step_m, noise_m, 0.02, *rc::gen::arbitrary<std::uint64_t>());
}

// 20 confirmations of probability 0.04 each: never in the age of the universe.
RC_GTEST_PROP(RoundingStep, IsNotFoundWhereThereIsNone, ()) {
  const double noise_m = std::pow(10, *number_between(-5.5, -3));
  RoundingStep<double> rounding;
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  for (int i = 0; i < 2000; ++i) {
    rounding.add(course_m(i) + noise_m * random.normal());
    RC_ASSERT(rounding.step_m() == 0.0);
  }
}

TEST(RoundingStep, RestSaysNothing) {
  RoundingStep<double> rounding;
  for (int i = 0; i < 1000; ++i) rounding.add(0.1);
  EXPECT_EQ(rounding.step_m(), 0);
}

// An export that is rounded in its first part only.
TEST(RoundingStep, IsGivenUpWhereItEnds) {
  RoundingStep<double> rounding;
  Random random(1);
  for (int i = 0; i < 400; ++i) rounding.add(1e-4 * std::round(course_m(i) / 1e-4));
  EXPECT_NEAR(rounding.step_m(), 1e-4, 1e-6);
  for (int i = 400; i < 600; ++i) rounding.add(course_m(i) + 3e-5 * random.normal());
  EXPECT_EQ(rounding.step_m(), 0);
}

TEST(RoundingStep, WhatIsNoNumberIsLeftOut) {
  RoundingStep<float> rounding;
  for (int i = 0; i < 400; ++i) {
    const double z = 1e-4 * std::round(course_m(i) / 1e-4);
    rounding.add(i % 50 == 7 ? std::numeric_limits<float>::max() : static_cast<float>(z));
  }
  EXPECT_NEAR(rounding.step_m(), 1e-4, 2e-6);
}

}  // namespace
}  // namespace condyle
