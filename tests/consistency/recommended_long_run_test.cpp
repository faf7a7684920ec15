// SPDX-License-Identifier: Apache-2.0
// Millions of steps in float: covariances stay covariances, estimates stay those of double.
//
// A member of the bank has a say from a weight of 1e-3 on, and which ones have decides whether a
// sample counts in full. Rounding can decide that, about once in ten million samples; the two then
// differ for a moment.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <iostream>

#include "condyle/estimator/motion/recommended_estimator.h"
#include "support/random.h"
#include "support/sanitizer.h"
#include "support/tier.h"

namespace condyle {
namespace {

using testing_support::Random;
using testing_support::runs;

#if CONDYLE_UNDER_SANITIZER || !defined(NDEBUG)
constexpr bool kIsSlowBuild = true;
#else
constexpr bool kIsSlowBuild = false;
#endif

// In units of its standard deviations.
bool is_positive_definite(const SymmetricMatrix3<float>& P) {
  const Eigen::Matrix3d dense = P.dense().cast<double>();
  const Eigen::Vector3d unit = dense.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d scaled = unit.asDiagonal() * dense * unit.asDiagonal();
  return scaled.allFinite() && scaled.llt().info() == Eigen::Success;
}

// Chewing of changing height, at 60 Hz.
double chewing_m(double t) {
  return (1 + 0.5 * std::sin(0.21 * t)) * (0.007 * std::sin(8.2 * t) + 0.002 * std::sin(16.4 * t));
}

void expect_float_is_double(TimeNs steps) {
  RecommendedEstimator<float, 1> in_float({});
  RecommendedEstimator<double, 1> in_double({});
  Random random(5);
  Vector3<double> squares = Vector3<double>::Zero(), difference_squares = squares;
  TimeNs far_apart = 0;
  for (TimeNs i = 0; i < steps; ++i) {
    const TimeNs time_ns = i * 16'666'667;
    const double z = chewing_m(seconds(time_ns)) + 5e-5 * random.normal();
    const auto a = in_float.step({time_ns, true, {static_cast<float>(z)}, {}}).axes[0];
    const auto b = in_double.step({time_ns, true, {z}, {}}).axes[0];
    const Vector3<double> one(static_cast<double>(a.position_m.value),
                              static_cast<double>(a.velocity_m_s.value),
                              static_cast<double>(a.acceleration_m_s2.value));
    const Vector3<double> other(b.position_m.value, b.velocity_m_s.value,
                                b.acceleration_m_s2.value);
    squares += other.cwiseAbs2();
    difference_squares += (one - other).cwiseAbs2();
    // Of the rms so far, from a minute on.
    const Vector3<double> allowed = 1e-3 * (squares / static_cast<double>(i + 1)).cwiseSqrt();
    far_apart += i > 3600 && ((one - other).array().abs() > allowed.array()).any();
    if (i % 1000 != 0 && i + 1 != steps) continue;
    for (int j = 0; j < in_float.bank().member_count(); ++j) {
      ASSERT_TRUE(is_positive_definite(in_float.bank().step(j).P)) << i;
    }
  }
  EXPECT_LE(far_apart, 1 + steps / 1'000'000);
  std::cout << "             farther apart than 1e-3 of the rms: " << far_apart << '\n';
  for (int j = 0; j < 3; ++j) {
    const double ratio = std::sqrt(difference_squares[j] / squares[j]);
    EXPECT_LT(ratio, 1e-4) << j;  // also where it is NaN
    std::cout << "             rms of the difference over rms: " << ratio << '\n';
  }
}

TEST(RecommendedLongRun, FloatStaysWithDouble) {
  const TimeNs steps = kIsSlowBuild ? 100'000 : runs(300'000, 500'000, 10'000'000);
  std::cout << "             " << steps << " steps\n";
  expect_float_is_double(steps);
}

}  // namespace
}  // namespace condyle
