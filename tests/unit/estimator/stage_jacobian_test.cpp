// SPDX-License-Identifier: Apache-2.0
// Every stage's Jacobian against central differences of its transition.
#include <gtest/gtest.h>

#include "condyle/estimator/published/friction_stage.h"
#include "condyle/estimator/published/mass_stage.h"
#include "condyle/estimator/published/motion_stage.h"
#include "support/rapidcheck_gtest.h"

namespace condyle {
namespace {

using testing_support::number_between;

template <class TransitionAt>
void expect_jacobian_matches(const TransitionAt& transition_at, const Vector3<double>& x) {
  const TransitionJacobian<double> J = transition_at(x).jacobian;
  Eigen::Matrix3d analytic;
  analytic << 1, J.pv, J.px, 0, J.vv, J.vx, 0, 0, 1;
  for (int column = 0; column < 3; ++column) {
    const double h = 1e-5 * std::max(1.0, std::abs(x[column]));
    Vector3<double> above = x, below = x;
    above[column] += h;
    below[column] -= h;
    const Vector3<double> difference =
        (transition_at(above).state - transition_at(below).state) / (above[column] - below[column]);
    for (int row = 0; row < 3; ++row) {
      RC_ASSERT(std::abs(difference[row] - analytic(row, column)) <=
                1e-6 * std::max(1.0, std::abs(analytic(row, column))));
    }
  }
}

RC_GTEST_PROP(StageJacobian, OfMotion, ()) {
  const auto form = *rc::gen::element(Discretisation::forward, Discretisation::backward);
  const double T = *number_between(0.002, 0.05), m0 = *number_between(0.05, 1);
  expect_jacobian_matches(
      [&](const Vector3<double>& x) { return motion_transition(x, T, m0, form); },
      {*number_between(-0.05, 0.05), *number_between(-0.3, 0.3), *number_between(-10, 10)});
}

RC_GTEST_PROP(StageJacobian, OfFriction, ()) {
  const double T = *number_between(0.002, 0.05), m0 = *number_between(0.05, 1);
  const double u = *number_between(-10, 10);
  expect_jacobian_matches(
      [&](const Vector3<double>& x) { return friction_transition(x, u, T, m0); },
      {*number_between(-0.05, 0.05), *number_between(-0.3, 0.3), *number_between(0, 20)});
}

RC_GTEST_PROP(StageJacobian, OfMass, ()) {
  const double T = *number_between(0.002, 0.05), kv = *number_between(0, 20);
  const double u = *number_between(-10, 10);
  expect_jacobian_matches(
      [&](const Vector3<double>& x) { return mass_transition(x, u, kv, T); },
      {*number_between(-0.05, 0.05), *number_between(-0.3, 0.3), *number_between(0.1, 1)});
}

}  // namespace
}  // namespace condyle
