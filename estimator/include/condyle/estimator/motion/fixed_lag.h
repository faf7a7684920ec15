// SPDX-License-Identifier: Apache-2.0
// Fixed-lag smoothing: the state at an instant, improved by the samples after it.
//
//   x, P    filtered state and covariance at the instant, all measurements up to it included
//   K, S    gain and innovation variance of a later measurement, nu its innovation
//   F       transition between two samples (white_jerk.h)
//   l, L    evidence of the later measurements: gradient and curvature of their log likelihood
//
// Backwards over a measurement of the position, H = (1 0 0), C = I - K H:
//   l <- C' l + H' nu / S,    L <- C' L C + H' H / S
// Backwards over a step:
//   l <- F' l,                L <- F' L F
// The smoothed state:
//   x + P l,   covariance P - P L P
//
// The form of A. E. Bryson and M. Frazier, modified by G. J. Bierman, Fixed interval smoothing with
// discrete measurements, Int. J. Control 18 (1973) 65-75: no matrix is inverted, so that float
// suffices. Units: P and S in units of the noise variance R (filter_bank.h), so l has 1/m, L none.
#pragma once

#include "condyle/estimator/motion/white_jerk.h"

namespace condyle {

/// State and variances along one axis: position, velocity, acceleration.
template <class Scalar>
struct MotionMoments {
  Vector3<Scalar> mean = Vector3<Scalar>::Zero();      ///< m, m/s, m/s^2
  Vector3<Scalar> variance = Vector3<Scalar>::Zero();  ///< squares of those, or in units of R
};

/// One member's filter after one sample: everything that smoothing needs.
template <class Scalar, int kAxes>
struct FilteredStep {
  SymmetricMatrix3<Scalar> P;                   ///< covariance, units of R
  Vector3<Scalar> K = Vector3<Scalar>::Zero();  ///< 0 if nothing was measured
  Scalar inverse_S = 0;                         ///< 0 if nothing was measured
  Array<Vector3<Scalar>, kAxes> x;              ///< m, m/s, m/s^2
  Array<Scalar, kAxes> innovation_m = {};       ///< nu

  FilteredStep() {
    for (Vector3<Scalar>& state : x) state.setZero();
  }
};

/// Evidence of later measurements about the state, along several axes that share the covariance.
template <class Scalar, int kAxes>
class LaterEvidence {
 public:
  LaterEvidence() {
    for (Vector3<Scalar>& gradient : l_) gradient.setZero();
  }

  /// Moves back across the measurement of `step`.
  void go_back_over_measurement(const FilteredStep<Scalar, kAxes>& step) {
    for (int axis = 0; axis < kAxes; ++axis) {
      Vector3<Scalar>& l = l_[axis];
      l[0] += step.innovation_m[axis] * step.inverse_S - step.K.dot(l);
    }
    const Vector3<Scalar> L_K = times(L_, step.K);
    L_(0, 0) += step.inverse_S - L_K[0] - L_K[0] + step.K.dot(L_K);
    L_(0, 1) -= L_K[1];
    L_(0, 2) -= L_K[2];
  }

  /// Moves back from the end of a step with transition `F` to its beginning.
  void go_back_over_step(const TransitionJacobian<Scalar>& F) {
    const Scalar T = F.vx, h = F.px;
    for (Vector3<Scalar>& l : l_) l = {l[0], T * l[0] + l[1], h * l[0] + T * l[1] + l[2]};
    // M = L F, then F' M
    const Scalar M_01 = T * L_(0, 0) + L_(0, 1);
    const Scalar M_02 = h * L_(0, 0) + T * L_(0, 1) + L_(0, 2);
    const Scalar M_11 = T * L_(0, 1) + L_(1, 1);
    const Scalar M_12 = h * L_(0, 1) + T * L_(1, 1) + L_(1, 2);
    const Scalar M_22 = h * L_(0, 2) + T * L_(1, 2) + L_(2, 2);
    L_(0, 1) = M_01;
    L_(0, 2) = M_02;
    L_(1, 1) = T * M_01 + M_11;
    L_(1, 2) = T * M_02 + M_12;
    L_(2, 2) = h * M_02 + T * M_12 + M_22;
  }

  /// Forgets the evidence: samples after this instant say nothing about earlier ones.
  void forget() { *this = LaterEvidence(); }

  /// Smoothed motion of `axis` at the instant of `step`, its variances in units of R. If a wide P
  /// shrinks so far that the digits of P - P L P are lost (after a start, in float), the filtered
  /// motion: correct, but with its larger variances.
  MotionMoments<Scalar> smoothed(const FilteredStep<Scalar, kAxes>& step, int axis) const {
    constexpr Scalar kFewestDigits = 8192 * std::numeric_limits<Scalar>::epsilon();
    const MotionMoments<Scalar> filtered = {step.x[axis],
                                            {step.P(0, 0), step.P(1, 1), step.P(2, 2)}};
    MotionMoments<Scalar> result = {step.x[axis] + times(step.P, l_[axis]), filtered.variance};
    for (int i = 0; i < 3; ++i) {
      const Vector3<Scalar> row = {step.P(i, 0), step.P(i, 1), step.P(i, 2)};
      result.variance[i] -= row.dot(times(L_, row));
      if (!(result.variance[i] > kFewestDigits * filtered.variance[i])) return filtered;
    }
    return result;
  }

 private:
  static Vector3<Scalar> times(const SymmetricMatrix3<Scalar>& A, const Vector3<Scalar>& x) {
    return {A(0, 0) * x[0] + A(0, 1) * x[1] + A(0, 2) * x[2],
            A(0, 1) * x[0] + A(1, 1) * x[1] + A(1, 2) * x[2],
            A(0, 2) * x[0] + A(1, 2) * x[1] + A(2, 2) * x[2]};
  }

  Array<Vector3<Scalar>, kAxes> l_;
  SymmetricMatrix3<Scalar> L_;
};

}  // namespace condyle
