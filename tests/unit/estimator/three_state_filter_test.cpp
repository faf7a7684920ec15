// SPDX-License-Identifier: Apache-2.0
// The packed filter against the textbook's matrices.
#include "condyle/estimator/math/three_state_filter.h"

#include <Eigen/Dense>

#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;
using Matrix3 = Eigen::Matrix3d;

Matrix3 random_covariance() {
  Matrix3 root;
  for (int i = 0; i < 9; ++i) root(i / 3, i % 3) = *number_between(-2, 2);
  return root * root.transpose() + 1e-3 * Matrix3::Identity();
}

SymmetricMatrix3<double> packed(const Matrix3& dense) {
  SymmetricMatrix3<double> result;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) result(i, j) = dense(i, j);
  }
  return result;
}

Vector3<double> random_vector() {
  return {*number_between(-3, 3), *number_between(-3, 3), *number_between(-3, 3)};
}

RC_GTEST_PROP(ThreeStateFilter, PredictionIsJPJtPlusQ, ()) {
  const Matrix3 P = random_covariance();
  const TransitionJacobian<double> J{*number_between(-1, 1), *number_between(-1, 1),
                                     *number_between(-1, 1), *number_between(-1, 1)};
  Matrix3 dense;
  dense << 1, J.pv, J.px, 0, J.vv, J.vx, 0, 0, 1;
  const Vector3<double> Q(0.1, 0.2, 0.3);
  const Matrix3 expected = dense * P * dense.transpose() + Matrix3(Q.asDiagonal());
  const Matrix3 actual = propagate_covariance(packed(P), J, Q).dense();
  RC_ASSERT((actual - expected).norm() <= 1e-13 * expected.norm());
}

RC_GTEST_PROP(ThreeStateFilter, StepsOfVelocityAndPositionAreTheirJacobians, ()) {
  const Matrix3 P = random_covariance();
  const double T = *number_between(-1, 1), vv = *number_between(-1, 1), vx = *number_between(-1, 1);
  Matrix3 velocity, position;
  velocity << 1, 0, 0, 0, vv, vx, 0, 0, 1;
  position << 1, T, 0, 0, 1, 0, 0, 0, 1;
  for (const bool velocity_first : {true, false}) {
    SymmetricMatrix3<double> actual = packed(P);
    if (velocity_first) step_velocity(actual, vv, vx);
    step_position(actual, T);
    if (!velocity_first) step_velocity(actual, vv, vx);
    const Matrix3 J = velocity_first ? Matrix3(position * velocity) : Matrix3(velocity * position);
    const Matrix3 expected = J * P * J.transpose();
    RC_ASSERT((actual.dense() - expected).norm() <= 1e-13 * P.norm());
  }
}

RC_GTEST_PROP(ThreeStateFilter, TwoScalarUpdatesAreTheJointUpdate, ()) {
  const Matrix3 P = random_covariance();
  const Vector3<double> x = random_vector();
  const Eigen::Vector2d z(*number_between(-3, 3), *number_between(-3, 3));
  const Eigen::Vector2d R(*number_between(0.01, 2), *number_between(0.01, 2));

  Eigen::Matrix<double, 2, 3> H;
  H << 1, 0, 0, 0, 1, 0;
  const Eigen::Matrix2d S = H * P * H.transpose() + Eigen::Matrix2d(R.asDiagonal());
  const Eigen::Matrix<double, 3, 2> K = P * H.transpose() * S.inverse();
  const Eigen::Vector2d innovation = z - H * x;
  const Vector3<double> expected_x = x + K * innovation;
  const Matrix3 expected_P = (Matrix3::Identity() - K * H) * P;
  const double expected_nis = innovation.dot(S.inverse() * innovation);

  ThreeStateFilter<double> filter;
  filter.x = x;
  filter.P = packed(P);
  const auto first = filter.update<kPosition>(z[0], R[0]);
  const auto second = filter.update<kVelocity>(z[1], R[1]);
  RC_ASSERT(!first.refused);
  RC_ASSERT(!second.refused);
  RC_ASSERT((filter.x - expected_x).norm() <= 1e-10 * (1 + expected_x.norm()));
  RC_ASSERT((filter.P.dense() - expected_P).norm() <= 1e-10 * P.norm());
  RC_ASSERT(std::abs(first.nis + second.nis - expected_nis) <= 1e-9 * (1 + expected_nis));
}

RC_GTEST_PROP(ThreeStateFilter, UpdatesKeepTheCovariancePositive, ()) {
  ThreeStateFilter<float> filter;
  const Matrix3 P = random_covariance();
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) filter.P(i, j) = static_cast<float>(P(i, j));
  }
  for (int step = 0; step < 50; ++step) {
    RC_ASSERT(!filter.update<kPosition>(0.1F, 0.01F).refused);
    RC_ASSERT(!filter.update<kVelocity>(0.1F, 0.01F).refused);
    filter.predict({filter.x, {0.1F, 0.01F, 0.9F, 0.1F}}, {1e-4F, 1e-4F, 1e-4F});
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(filter.P.dense());
    RC_ASSERT(solver.eigenvalues()[0] > 0);
  }
}

TEST(ThreeStateFilter, RefusesAnInnovationVarianceThatIsNoVariance) {
  for (const double bad : {-2.0, 0.0, std::nan(""), HUGE_VAL}) {
    ThreeStateFilter<double> filter;
    filter.initialise({1, 2, 3}, {1, 1, 1});
    filter.P(0, 0) = bad;
    const auto before = filter;
    EXPECT_TRUE(filter.update<kPosition>(7, 0).refused) << bad;
    EXPECT_EQ(filter.x, before.x);
    EXPECT_EQ(filter.P(1, 1), before.P(1, 1));
  }
}

}  // namespace
}  // namespace condyle
