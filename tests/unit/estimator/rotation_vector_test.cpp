// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/pose/rotation_vector.h"

#include <numbers>

#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing_support::number_between;

Vector3d any_direction() {
  const Vector3d v(*number_between(-1, 1), *number_between(-1, 1), *number_between(-1, 1));
  RC_PRE(v.norm() > 0.01);
  return v.normalized();
}

// From 1e-12 rad to just below a half turn; every size is likely.
Vector3d any_rotation() {
  const double exponent = *number_between(-12, std::log10(3.1));
  return std::pow(10, exponent) * any_direction();
}

RC_GTEST_PROP(RotationVector, TheExponentialIsTheRotation, ()) {
  const Vector3d w = any_rotation();
  const Matrix3d R = rotation_of(w);
  const Matrix3d expected = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  RC_ASSERT((R - expected).norm() <= 2e-15);
  RC_ASSERT((R.transpose() * R - Matrix3d::Identity()).norm() <= 3e-15);
  RC_ASSERT(std::abs(R.determinant() - 1) <= 2e-15);
}

RC_GTEST_PROP(RotationVector, TheLogarithmReturnsTheVectorWithAllItsDigits, ()) {
  const Vector3d w = any_rotation();
  RC_ASSERT((rotation_vector_of(rotation_of(w)) - w).norm() <= 1e-12 * w.norm());
}

RC_GTEST_PROP(RotationVector, FloatLosesNoDigitsOfASmallAngle, ()) {
  const Eigen::Vector3f w = any_rotation().cast<float>();
  RC_ASSERT((rotation_vector_of(rotation_of(w)) - w).norm() <= 2e-6F * w.norm());
}

TEST(RotationVector, NoRotationIsZero) {
  EXPECT_EQ(rotation_of<double>(Vector3d::Zero()), Matrix3d::Identity());
  EXPECT_EQ(rotation_vector_of<double>(Matrix3d::Identity()), Vector3d::Zero());
  EXPECT_EQ(left_jacobian<double>(Vector3d::Zero()), Matrix3d::Identity());
  EXPECT_EQ(inverse_left_jacobian<double>(Vector3d::Zero()), Matrix3d::Identity());
}

TEST(RotationVector, AHalfTurnHasALogarithm) {
  for (int axis = 0; axis < 3; ++axis) {
    const Matrix3d R =
        2 * Vector3d::Unit(axis) * Vector3d::Unit(axis).transpose() - Matrix3d::Identity();
    EXPECT_NEAR(rotation_vector_of(R).norm(), std::numbers::pi, 1e-15);
    EXPECT_LE((rotation_of(rotation_vector_of(R)) - R).norm(), 1e-15);
  }
}

RC_GTEST_PROP(RotationVector, TheJacobianIsThatOfTheExponential, ()) {
  const Vector3d w = any_rotation(), step = 1e-4 * any_direction();
  // Central difference: its error is of the order of step^2.
  const Matrix3d turn = rotation_of<double>(w + step) * rotation_of<double>(w - step).transpose();
  RC_ASSERT((rotation_vector_of(turn) - 2 * (left_jacobian(w) * step)).norm() <= 1e-11);
}

RC_GTEST_PROP(RotationVector, TheInverseJacobianIsTheInverse, ()) {
  const Vector3d w = any_rotation();
  const Matrix3d product = left_jacobian(w) * inverse_left_jacobian(w);
  // The inverse grows to infinity at a full turn, not before.
  RC_ASSERT((product - Matrix3d::Identity()).norm() <= 1e-14);
}

RC_GTEST_PROP(RotationVector, AJacobianTurnsItsVectorIntoItself, ()) {
  const Vector3d w = any_rotation();
  RC_ASSERT((left_jacobian(w) * w - w).norm() <= 1e-15 * w.norm());
}

RC_GTEST_PROP(SwingTwist, AreTheTurnsThatTheRotationIsMadeOf, ()) {
  const Vector3d axis = any_direction();
  const Vector3d across = axis.cross(any_direction());
  RC_PRE(across.norm() > 0.01);
  const double twist = *number_between(-3, 3), swing = *number_between(0, 2.5);
  const Matrix3d R =
      rotation_of<double>(swing * across.normalized()) * rotation_of<double>(twist * axis);
  const auto found = swing_twist_of<double>(rotation_vector_of(R), axis);
  RC_ASSERT(std::abs(found.twist_rad - twist) <= 1e-14);
  RC_ASSERT(std::abs(found.swing_rad - swing) <= 1e-14);
}

RC_GTEST_PROP(SwingTwist, GradientsAreThoseOfASmallRotationThatFollows, ()) {
  const Vector3d axis = any_direction();
  const Vector3d across = axis.cross(any_direction());
  RC_PRE(across.norm() > 0.01);
  const double twist = *number_between(-2, 2), swing = *number_between(0.05, 2);
  const Matrix3d R =
      rotation_of<double>(swing * across.normalized()) * rotation_of<double>(twist * axis);
  const auto at = [&](const Vector3d& turn) {
    return swing_twist_of<double>(rotation_vector_of<double>(rotation_of(turn) * R), axis);
  };
  RC_PRE(rotation_vector_of(R).norm() < 3);  // the twist jumps at a half turn
  const Vector3d step = 1e-5 * any_direction();
  const auto middle = at(Vector3d::Zero()), ahead = at(step), behind = at(-step);
  // The curvature of the swing is that of 1/swing.
  RC_ASSERT(std::abs((ahead.twist_rad - behind.twist_rad) / 2 - middle.twist_gradient.dot(step)) <=
            1e-12);
  RC_ASSERT(std::abs((ahead.swing_rad - behind.swing_rad) / 2 - middle.swing_gradient.dot(step)) <=
            1e-12);
}

TEST(SwingTwist, WithoutSwingOnlyTheTwistHasAGradient) {
  const auto found = swing_twist_of<double>(Vector3d(0, 0.3, 0), Vector3d::UnitY());
  EXPECT_DOUBLE_EQ(found.twist_rad, 0.3);
  EXPECT_EQ(found.swing_rad, 0);
  EXPECT_LE((found.twist_gradient - Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_EQ(found.swing_gradient, Vector3d::Zero());
}

}  // namespace
}  // namespace condyle
