// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/motion/unseen_tremor.h"

#include <cmath>

#include "condyle/estimator/motion/recommended_estimator.h"
#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;

constexpr double kA = UnseenTremor<double>::kAcceleration_m_s2;
const double kW = std::sqrt(UnseenTremor<double>::kSquareRate_s2);
const UnseenTremor<double> kTremor(4);

// Of a settled filter of the bandwidth `b` (rad/s), steps of `T` s, in units of R.
SymmetricMatrix3<double> settled(double b, double T) {
  SymmetricMatrix3<double> P;
  P(0, 0) = 2 * b * T;
  P(0, 1) = 2 * b * b * T;
  P(0, 2) = std::pow(b, 3) * T;
  P(1, 1) = 3 * std::pow(b, 3) * T;
  P(1, 2) = 2 * std::pow(b, 4) * T;
  P(2, 2) = 2 * std::pow(b, 5) * T;
  return P;
}
Vector3<double> added(double R, const SymmetricMatrix3<double>& P, double later_s = 0) {
  return kTremor.of_filter(R, shown_by_itself(P), later_s);
}

struct Errors {
  Vector3<double> true_variance = Vector3<double>::Zero(), added_variance;
};

// A filter of known noise and density that has settled on a tremor of 8 Hz, `lag` samples late: its
// errors, no noise being there, and what is added for them if it allows for none. A quarter of a
// turn apart, two phases stand for all.
Errors errors_of_filter(double b, double T, int lag) {
  constexpr double kNoise_m = 1e-3;  // far above the tremor, so that nothing is an outlier
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  parameters.noise.position_sd_m = kNoise_m;
  parameters.noise.jerk_density_m2_s5 = std::pow(b, 6) * kNoise_m * kNoise_m * T;
  Errors errors;
  for (const double phase : {0.0, std::acos(0.0)}) {
    RecommendedEstimator<double, 1> estimator(parameters, lag);
    const double height_m = std::sqrt(2) * kA / (kW * kW);
    RecommendedEstimate<double> estimate;
    const int count = static_cast<int>(60 / (b * T)) + 20;
    for (int i = 0; i < count; ++i) {
      const double t = i * T;
      estimate = estimator.step({nanoseconds(t), true, {height_m * std::sin(kW * t + phase)}, {}});
    }
    const double turn = kW * seconds(estimate.time_ns) + phase;
    const auto& axis = estimate.axes[0];
    const Vector3<double> error(axis.position_m.value - height_m * std::sin(turn),
                                axis.velocity_m_s.value - height_m * kW * std::cos(turn),
                                axis.acceleration_m_s2.value + height_m * kW * kW * std::sin(turn));
    errors.true_variance += error.cwiseAbs2() / 2;
    errors.added_variance = kTremor.of_filter(
        kNoise_m * kNoise_m, {estimator.bank().step(0).P, Vector3<double>::Zero()}, lag * T);
  }
  return errors;
}

// The formulas are those of continuous time.
RC_GTEST_PROP(UnseenTremor, IsTheErrorOfAFilterThatDoesNotFollowIt, ()) {
  const double b = kW * std::pow(10, *number_between(-0.7, 0.1));
  const auto [truth, stated] = errors_of_filter(b, 0.03 / b, 0);
  for (int i = 0; i < 3; ++i) {
    RC_ASSERT(stated[i] > 0.8 * truth[i]);
    RC_ASSERT(stated[i] < 1.2 * truth[i]);
  }
}

// Later samples show some of it.
RC_GTEST_PROP(UnseenTremor, IsTheErrorOfASmootherToo, ()) {
  const double b = kW * std::pow(10, *number_between(-0.7, 0.1));
  const int lag = *rc::gen::inRange(1, 17);
  const auto [truth, stated] = errors_of_filter(b, 0.1 / b, lag);
  for (int i = 0; i < 3; ++i) RC_ASSERT(stated[i] > 0.7 * truth[i]);
}

RC_GTEST_PROP(UnseenTremor, LaterSamplesDoNotAddToIt, ()) {
  const double R = std::pow(10, *number_between(-12, -7));
  const auto P = settled(std::pow(10, *number_between(0, 4)), 0.01);
  const double later_s = std::pow(10, *number_between(-3, 1));
  const auto now = added(R, P), soon = added(R, P, later_s), late = added(R, P, 1.5 * later_s);
  for (int i = 0; i < 3; ++i) {
    RC_ASSERT(soon[i] <= now[i] * (1 + 1e-12));
    RC_ASSERT(late[i] <= soon[i] * (1 + 1e-12));
    RC_ASSERT(late[i] >= 0);
  }
}

// No more than the jaw's, and no more than the noise hides.
RC_GTEST_PROP(UnseenTremor, KeepsItsBounds, ()) {
  const double R = std::pow(10, *number_between(-12, -7));
  const auto variance = added(R, settled(std::pow(10, *number_between(0, 4)), 0.01));
  RC_ASSERT(variance[0] <= R);
  RC_ASSERT(variance[0] <= std::pow(kA / (kW * kW), 2));
  RC_ASSERT(variance[1] <= 2.6 * std::pow(kA / kW, 2));
  RC_ASSERT(variance[2] <= 2.6 * kA * kA);
}

// At rest, where the noise hides it, it is there; a filter of a fast motion allows for it.
TEST(UnseenTremor, IsAddedWhereTheFilterDoesNotAllowForIt) {
  const Vector3<double> still = added(1e-8, settled(10, 0.001));
  const Vector3<double> all(std::pow(kA / (kW * kW), 2), std::pow(kA / kW, 2), kA * kA);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(still[i] / all[i], 1, 0.2) << i;
  for (const double b : {100.0, 300.0, 1000.0}) {
    EXPECT_EQ(added(1e-8, settled(b, 0.001)).norm(), 0) << b;
  }
}

TEST(UnseenTremor, IsNoLargerThanAJawsAcceleration) {
  const UnseenTremor<double> slow(1e-4);
  const auto P = settled(10, 0.01);
  EXPECT_LT(slow.of_filter(1e-8, shown_by_itself(P), 0)[2], 1.2e-4);
}

TEST(UnseenTremor, IsFiniteInFloat) {
  const UnseenTremor<float> tremor(4);
  for (const float vv : {0.0F, 1e-30F, 1.0F, 1e30F}) {
    for (const float aa : {0.0F, 1e-30F, 1.0F, 1e30F}) {
      const auto P = SymmetricMatrix3<float>::diagonal({1, vv, aa});
      for (const float later_s : {0.0F, 0.1F}) {
        const Vector3<float> variance = tremor.of_filter(1e-8F, shown_by_itself(P), later_s);
        EXPECT_TRUE(variance.allFinite()) << vv << " " << aa;
        EXPECT_GE(variance.minCoeff(), 0) << vv << " " << aa;
      }
    }
  }
}

}  // namespace
}  // namespace condyle
