// SPDX-License-Identifier: Apache-2.0
// Motion along one axis whose jerk is white noise, discretised exactly for any time step.
//
//   p, v, a   position (m), velocity (m/s), acceleration (m/s^2); the state
//   T         time step (s), from the samples' times
//   q         spectral density of the jerk (m^2/s^5)
//
// Model:       p' = v,  v' = a,  a' = w,  w white noise of density q
// Transition:      | 1  T  T^2/2 |          | T^5/20  T^4/8  T^3/6 |
//              F = | 0  1    T   |    Q = q |         T^3/3  T^2/2 |
//                  | 0  0    1   |          |                  T   |
// Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation
// (2001), section 6.2.3, the continuous Wiener process acceleration model.
#pragma once

#include "condyle/estimator/math/three_state_filter.h"

namespace condyle {

/// F for a step of `T` s.
template <class Scalar>
TransitionJacobian<Scalar> white_jerk_jacobian(Scalar T) {
  return {.pv = T, .px = T * T / Scalar(2), .vv = 1, .vx = T};
}

/// F x: the state (m, m/s, m/s^2) that follows `x` by `F`.
template <class Scalar>
Vector3<Scalar> white_jerk_transition(const Vector3<Scalar>& x,
                                      const TransitionJacobian<Scalar>& F) {
  return {x[kPosition] + F.pv * x[kVelocity] + F.px * x[kThird], x[kVelocity] + F.vx * x[kThird],
          x[kThird]};
}

/// Q / q for a step of `T` s.
template <class Scalar>
SymmetricMatrix3<Scalar> white_jerk_covariance(Scalar T) {
  enum { p = kPosition, v = kVelocity, a = kThird };
  const Scalar T2 = T * T, T3 = T2 * T;
  SymmetricMatrix3<Scalar> Q;
  Q(p, p) = T2 * T3 / Scalar(20);
  Q(p, v) = T2 * T2 / Scalar(8);
  Q(p, a) = T3 / Scalar(6);
  Q(v, v) = T3 / Scalar(3);
  Q(v, a) = T2 / Scalar(2);
  Q(a, a) = T;
  return Q;
}

}  // namespace condyle
