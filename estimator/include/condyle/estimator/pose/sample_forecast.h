// SPDX-License-Identifier: Apache-2.0
// Whether a filter will expect a sample, before it is given the sample.
//
// MotionHypotheses (motion_hypotheses.h) judges a sample and uses it in one call. Where two filters
// share one decision, each is asked here first. Only the position's entries of the prediction are
// computed.
//
//   f        row of the transition for the position: 1, T, T^2/2
//   S        innovation variance of a member in units of R: f P f' + r Q_pp + 1
#pragma once

#include "condyle/estimator/motion/motion_hypotheses.h"

namespace condyle {

/// True if `bank`, `T` s after its last sample, would find `z_m` an outlier by `gate`.
template <class Scalar, int kAxes>
bool foresees_outlier(const FilterBank<Scalar, kAxes>& bank, const Array<Scalar, kAxes>& z_m,
                      Scalar T, const OutlierGate<Scalar>& gate) {
  using Weights = typename FilterBank<Scalar, kAxes>::Weights;
  const auto F = white_jerk_jacobian(T);
  const Scalar Q_pp = white_jerk_covariance(T)(kPosition, kPosition);
  Array<Scalar, kAxes> least;
  for (Scalar& squared : least) squared = std::numeric_limits<Scalar>::infinity();
  for (int i = 0; i < bank.member_count(); ++i) {
    const auto& step = bank.step(i);
    const auto& P = step.P;
    const Scalar S = P(0, 0) + F.pv * (2 * P(0, 1) + F.pv * P(1, 1)) +
                     F.px * (2 * P(0, 2) + 2 * F.pv * P(1, 2) + F.px * P(2, 2)) +
                     bank.ratio(i) * Q_pp + Scalar(1);
    for (int axis = 0; axis < kAxes; ++axis) {
      if (!(bank.weight(axis, i) > Weights::kLikelyWeight)) continue;
      const Scalar innovation_m = z_m[axis] - white_jerk_transition(step.x[axis], F)[kPosition];
      least[axis] = std::min(least[axis], innovation_m * innovation_m / (bank.R(axis, i) * S));
    }
  }
  for (const Scalar squared : least) {
    if (gate.is_outlier(squared)) return true;
  }
  return false;
}

/// The same for `motion`: neither of its hypotheses expects `z_m`.
template <class Scalar, int kAxes>
bool foresees_outlier(const MotionHypotheses<Scalar, kAxes>& motion,
                      const Array<Scalar, kAxes>& z_m, Scalar T, const OutlierGate<Scalar>& gate) {
  return foresees_outlier(motion.main(), z_m, T, gate) &&
         !(motion.has_other() && !foresees_outlier(motion.other(), z_m, T, gate));
}

}  // namespace condyle
