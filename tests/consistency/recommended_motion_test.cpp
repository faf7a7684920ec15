// SPDX-License-Identifier: Apache-2.0
// How well the recommended estimator sees velocity on simulated chewing, against the white-jerk
// filter of known noise at its grid-best density. Nothing here is random.
#include <gtest/gtest.h>

#include <iostream>

#include "consistency/motion_vectors.h"

namespace condyle {
namespace {

using namespace testing_support;

class RecommendedMotion : public testing::TestWithParam<MotionFile> {};

std::string name_of(const testing::TestParamInfo<MotionFile>& info) {
  return info.param.name;
}
INSTANTIATE_TEST_SUITE_P(Files, RecommendedMotion, testing::ValuesIn(kMotionFiles), name_of);

double error(const MotionEstimatorParameters& parameters, int lag, const MotionVector& motion,
             double from_s = kSettled_s) {
  return velocity_error(motion, estimate_motion<double>(parameters, lag, motion), from_s);
}

void print(const std::string& what, double ratio) {
  std::cout << "             " << what << " " << ratio << '\n';
}

TEST_P(RecommendedMotion, KnowingNoiseAndDensityIsAsGoodAsTheGridBest) {
  const MotionVector motion = read_motion(GetParam().name);
  const WhiteJerkFit best = best_white_jerk_fit(motion, kSettled_s);
  EXPECT_NEAR(best.error_m_s / GetParam().error_m_s[0], 1, 0.01);
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  parameters.noise.position_sd_m = GetParam().noise_sd_m;
  parameters.noise.jerk_density_m2_s5 = best.ratio * std::pow(GetParam().noise_sd_m, 2);
  for (std::size_t i = 0; i < 4; ++i) {
    const double ratio = error(parameters, kMotionLags[i], motion) / GetParam().error_m_s[i];
    EXPECT_LE(ratio, kMotionLags[i] == 0 ? 1.05 : 1.1) << kMotionLags[i] << " late";
    print("lag " + std::to_string(kMotionLags[i]) + ":", ratio);
  }
}

TEST_P(RecommendedMotion, KnowingNothingIsAsGood) {
  const MotionVector motion = read_motion(GetParam().name);
  for (std::size_t i = 0; i < 4; ++i) {
    const double ratio = error({}, kMotionLags[i], motion) / GetParam().error_m_s[i];
    EXPECT_LE(ratio, kMotionLags[i] == 0 ? 1.05 : 1.1) << kMotionLags[i] << " late";
    print("lag " + std::to_string(kMotionLags[i]) + ":", ratio);
  }
}

TEST_P(RecommendedMotion, KnowingNothingIsAsGoodForSmallAndLargeMotion) {
  for (const double scale : {0.3, 3.0}) {
    const MotionVector motion = read_motion(GetParam().name, scale);
    const double ratio = error({}, 0, motion) / best_white_jerk_fit(motion, kSettled_s).error_m_s;
    EXPECT_LE(ratio, 1.05) << scale;
    print("scale " + std::to_string(scale) + ":", ratio);
  }
}

TEST_P(RecommendedMotion, FloatIsAsGood) {
  const MotionVector motion = read_motion(GetParam().name);
  const auto estimates = estimate_motion<float>({}, 0, motion);
  EXPECT_LE(velocity_error(motion, estimates, kSettled_s), 1.05 * GetParam().error_m_s[0]);
}

// The first guess of the standard deviation wrong by sqrt(10) and by 10.
TEST_P(RecommendedMotion, AWrongFirstGuessOfTheNoiseIsForgottenAfterFiveSeconds) {
  const MotionVector motion = read_motion(GetParam().name);
  const double best = best_white_jerk_fit(motion, 5).error_m_s;
  for (const double factor : {0.1, std::sqrt(0.1), std::sqrt(10.0), 10.0}) {
    MotionEstimatorParameters parameters;
    parameters.noise.position_sd_m = factor * GetParam().noise_sd_m;
    const double ratio = error(parameters, 0, motion, 5) / best;
    EXPECT_LE(ratio, 1.1) << factor;
    print("first guess times " + std::to_string(factor) + ":", ratio);
  }
}

// On average; and at every instant within what lets the velocity be as good as it is.
TEST_P(RecommendedMotion, FindsTheNoise) {
  for (const double scale : {0.3, 1.0, 3.0}) {
    const MotionVector motion = read_motion(GetParam().name, scale);
    double sum = 0, count = 0, least = HUGE_VAL, most = 0;
    for (const auto& estimate : estimate_motion<double>({}, 0, motion)) {
      if (seconds(estimate.time_ns) < kSettled_s) continue;
      const double ratio = estimate.axes[0].noise_sd_m / GetParam().noise_sd_m;
      sum += ratio;
      ++count;
      least = std::min(least, ratio);
      most = std::max(most, ratio);
    }
    EXPECT_NEAR(sum / count, 1, 0.2) << scale;
    EXPECT_GT(least, 0.65) << scale;
    EXPECT_LT(most, 1.3) << scale;
    print("scale " + std::to_string(scale) + ": noise found / true", sum / count);
    print("  least", least);
    print("  most", most);
  }
}

}  // namespace
}  // namespace condyle
