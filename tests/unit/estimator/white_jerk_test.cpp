// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/motion/white_jerk.h"

#include "support/rapidcheck_gtest.h"
#include "unit/estimator/dense_white_jerk.h"

namespace condyle {
namespace {

using testing_support::number_between;
using testing_support::RealMatrix;
using testing_support::white_jerk_by_series;
using Matrix3 = Eigen::Matrix3d;

Matrix3 dense(const TransitionJacobian<double>& F) {
  Matrix3 matrix;
  matrix << 1, F.pv, F.px, 0, F.vv, F.vx, 0, 0, 1;
  return matrix;
}

// Every entry, so that the small ones count too.
bool agrees(const Matrix3& actual, const Matrix3& expected, double tolerance) {
  return ((actual - expected).array().abs() <= tolerance * expected.array().abs()).all();
}

// From a nanosecond to ten seconds.
double random_step() {
  return std::pow(10, *number_between(-9, 1));
}

RC_GTEST_PROP(WhiteJerk, TransitionAndCovarianceAreTheExponentials, ()) {
  const double T = random_step();
  const auto expected = white_jerk_by_series(T);
  RC_ASSERT(agrees(dense(white_jerk_jacobian(T)), expected.F.cast<double>(), 1e-15));
  RC_ASSERT(agrees(white_jerk_covariance(T).dense(), expected.Q.cast<double>(), 1e-15));
}

RC_GTEST_PROP(WhiteJerk, TwoStepsAreOne, ()) {
  const double T = random_step(), first = T * *number_between(0, 1), second = T - first;
  const Matrix3 F = dense(white_jerk_jacobian(second));
  RC_ASSERT(agrees(F * dense(white_jerk_jacobian(first)), dense(white_jerk_jacobian(T)), 1e-14));
  const Matrix3 Q = F * white_jerk_covariance(first).dense() * F.transpose() +
                    white_jerk_covariance(second).dense();
  RC_ASSERT(agrees(Q, white_jerk_covariance(T).dense(), 1e-13));
}

// Q = integral of F(s) G G' F(s)' from 0 to T, G = (0 0 1)': five-point Gauss is exact for s^4.
TEST(WhiteJerk, CovarianceIsTheIntegral) {
  const double node[] = {0, 0.5384693101056831, -0.5384693101056831, 0.906179845938664,
                         -0.906179845938664};
  const double weight[] = {0.5688888888888889, 0.47862867049936647, 0.47862867049936647,
                           0.23692688505618908, 0.23692688505618908};
  const double T = 0.0167;
  Matrix3 Q = Matrix3::Zero();
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d column = dense(white_jerk_jacobian(T / 2 * (1 + node[i]))).col(2);
    Q += T / 2 * weight[i] * column * column.transpose();
  }
  EXPECT_TRUE(agrees(white_jerk_covariance(T).dense(), Q, 1e-14));
}

TEST(WhiteJerk, NoTimeChangesNothing) {
  EXPECT_EQ(dense(white_jerk_jacobian(0.0)), Matrix3::Identity());
  EXPECT_EQ(white_jerk_covariance(0.0).dense(), Matrix3::Zero());
  const Vector3<double> x(1, -2, 3);
  EXPECT_EQ(white_jerk_transition(x, white_jerk_jacobian(0.0)), x);
}

RC_GTEST_PROP(WhiteJerk, TheStateFollowsTheJacobian, ()) {
  const Vector3<double> x(*number_between(-1, 1), *number_between(-1, 1), *number_between(-1, 1));
  const auto F = white_jerk_jacobian(*number_between(0, 2));
  RC_ASSERT((white_jerk_transition(x, F) - dense(F) * x).norm() <= 1e-15 * (1 + dense(F).norm()));
}

}  // namespace
}  // namespace condyle
