// SPDX-License-Identifier: Apache-2.0
// The extended Kalman filter that all three stages share.
//
//   x   state (position, velocity, third), third = net force, friction or mass
//   P   covariance of x, kept as its upper triangle
//   J   Jacobian of the transition; every stage's has the shape
//           | 1  pv  px |
//           | 0  vv  vx |      p, v, x: rows and columns position, velocity, third
//           | 0  0   1  |
//   Q   process variances (diagonal), R measurement variance, z measurement
//
// Prediction, eq (20):  P <- J P J' + Q
// Update, eqs (21)-(23), for a measurement of the single state i (H picks it, R is diagonal, so the
// measurements are taken one after the other with the same result as together):
//   S = P_ii + R,  K = P_.i / S,  x <- x + K (z - x_i),  P_jk <- P_jk - K_j P_ik.
// Row i needs no subtraction: P_ji - P_ji P_ii / S = K_j R.
//
// The covariance does not depend on x: filters of the same model may share one and its gains.
#pragma once

#include "condyle/estimator/arithmetic.h"
#include "condyle/estimator/symmetric_matrix.h"

namespace condyle {

/// Index of a state in the vector x.
enum StateIndex : int { kPosition = 0, kVelocity = 1, kThird = 2 };

/// The entries of a stage's Jacobian J that are not fixed by its shape.
template <class Scalar>
struct TransitionJacobian {
  Scalar pv{};  ///< d position' / d velocity
  Scalar px{};  ///< d position' / d third
  Scalar vv{};  ///< d velocity' / d velocity
  Scalar vx{};  ///< d velocity' / d third
};

/// A stage's transition at one state: where it goes and how that depends on it.
template <class Scalar>
struct Transition {
  Vector3<Scalar> state;
  TransitionJacobian<Scalar> jacobian;
};

/// J P J' for a covariance P. Units of x squared.
template <class Scalar>
SymmetricMatrix3<Scalar> propagate_covariance(const SymmetricMatrix3<Scalar>& P,
                                              const TransitionJacobian<Scalar>& J) {
  enum { p = kPosition, v = kVelocity, x = kThird };
  // A = J P
  const Scalar A_pp = P(p, p) + J.pv * P(p, v) + J.px * P(p, x);
  const Scalar A_pv = P(p, v) + J.pv * P(v, v) + J.px * P(v, x);
  const Scalar A_px = P(p, x) + J.pv * P(v, x) + J.px * P(x, x);
  const Scalar A_vv = J.vv * P(v, v) + J.vx * P(v, x);
  const Scalar A_vx = J.vv * P(v, x) + J.vx * P(x, x);
  // A J'
  SymmetricMatrix3<Scalar> predicted;
  predicted(p, p) = A_pp + J.pv * A_pv + J.px * A_px;
  predicted(p, v) = J.vv * A_pv + J.vx * A_px;
  predicted(p, x) = A_px;
  predicted(v, v) = J.vv * A_vv + J.vx * A_vx;
  predicted(v, x) = A_vx;
  predicted(x, x) = P(x, x);
  return predicted;
}

/// J P J' + Q for a covariance P and a diagonal Q (eq 20). Units of x squared.
template <class Scalar>
SymmetricMatrix3<Scalar> propagate_covariance(const SymmetricMatrix3<Scalar>& P,
                                              const TransitionJacobian<Scalar>& J,
                                              const Vector3<Scalar>& process_variance) {
  SymmetricMatrix3<Scalar> predicted = propagate_covariance(P, J);
  for (int i = 0; i < 3; ++i) predicted(i, i) += process_variance[i];
  return predicted;
}

/// What a scalar measurement does to the covariance, and how the state is to follow.
template <class Scalar>
struct ScalarGain {
  Vector3<Scalar> K = Vector3<Scalar>::Zero();
  Scalar inverse_S = 0;  ///< 1 / innovation variance; 0 where refused
  bool refused = false;  ///< S was not positive and finite: the covariance is untouched
};

/// Updates `P` for a measurement of state `i` with variance `R` (eqs 21, 23).
template <int i, class Scalar>
[[nodiscard]] ScalarGain<Scalar> update_covariance(SymmetricMatrix3<Scalar>& P, Scalar R) {
  const Scalar S = P(i, i) + R;
  ScalarGain<Scalar> gain;
  if (!(S > Scalar(0)) || !std::isfinite(S)) {
    gain.refused = true;
    return gain;
  }
  constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
  gain.inverse_S = Scalar(1) / S;
  const Scalar K_i = P(i, i) * gain.inverse_S, K_j = P(j, i) * gain.inverse_S,
               K_k = P(k, i) * gain.inverse_S;
  P(j, j) -= K_j * P(j, i);
  P(j, k) -= K_j * P(k, i);
  P(k, k) -= K_k * P(k, i);
  P(i, i) = K_i * R;
  P(j, i) = K_j * R;
  P(k, i) = K_k * R;
  gain.K[i] = K_i;
  gain.K[j] = K_j;
  gain.K[k] = K_k;
  return gain;
}

/// What one scalar measurement said.
template <class Scalar>
struct ScalarUpdate {
  Scalar innovation{};  ///< z - x_i before the update, unit of the measured state
  Scalar nis{};  ///< innovation^2 / S: chi-square with 1 degree of freedom if the model holds
  bool refused = false;  ///< S was not positive and finite: state and covariance are untouched
};

/// State and covariance of one stage, with the two operations of the extended Kalman filter.
template <class Scalar>
struct ThreeStateFilter {
  Vector3<Scalar> x = Vector3<Scalar>::Zero();
  SymmetricMatrix3<Scalar> P;

  /// Starts at state `x0` with independent errors of variances `initial_variance`.
  void initialise(const Vector3<Scalar>& x0, const Vector3<Scalar>& initial_variance) {
    x = x0;
    P = SymmetricMatrix3<Scalar>::diagonal(initial_variance);
  }

  /// Moves state and covariance along `transition` (eq 20).
  void predict(const Transition<Scalar>& transition, const Vector3<Scalar>& process_variance) {
    x = transition.state;
    P = propagate_covariance(P, transition.jacobian, process_variance);
  }

  /// Takes the measurement `z` of state `i` with variance `R` (eqs 21-23). Nothing is changed where
  /// S is not positive and finite; the caller reports it.
  template <int i>
  [[nodiscard]] ScalarUpdate<Scalar> update(Scalar z, Scalar R) {
    const ScalarGain<Scalar> gain = update_covariance<i>(P, R);
    ScalarUpdate<Scalar> result;
    result.innovation = z - x[i];
    result.refused = gain.refused;
    if (gain.refused) return result;
    result.nis = result.innovation * result.innovation * gain.inverse_S;
    x += gain.K * result.innovation;
    return result;
  }
};

}  // namespace condyle
