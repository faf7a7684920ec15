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
// J is a step of the velocity and a step of the position, one after the other:
//   v <- vv v + vx x          P_pv <- vv P_pv + vx P_px
//                             P_vv <- vv (vv P_vv + vx P_vx) + vx P_vx'
//                             P_vx <- vv P_vx + vx P_xx  (= P_vx')
//   p <- p + T v              P_pp <- P_pp + T (P_pv + P_pv')
//                             P_pv <- P_pv + T P_vv      (= P_pv')
//                             P_px <- P_px + T P_vx
// Backward Euler takes the velocity first (pv = T vv, px = T vx), forward Euler the position
// (pv = T, px = 0). That is 19 multiplications and additions where J P J' has 28.
//
// Update, eqs (21)-(23), for a measurement of the single state i (H picks it, R is diagonal, so the
// measurements are taken one after the other with the same result as together):
//   S = P_ii + R,  K = P_.i / S,  x <- x + K (z - x_i),  P_jk <- P_jk - K_j P_ik.
// Row i needs no subtraction: P_ji - P_ji P_ii / S = K_j R.
//
// Always inlined: when called, these functions pass P through memory, written scalar by scalar and
// copied in pairs, and the processor cannot forward such stores to such loads (see
// estimator/CMakeLists.txt).
//
// The covariance does not depend on x: filters of the same model may share one and its gains.
#pragma once

#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/math/symmetric_matrix.h"

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

/// A stage's transition at one state: the new state and its derivatives.
template <class Scalar>
struct Transition {
  Vector3<Scalar> state;
  TransitionJacobian<Scalar> jacobian;
};

/// J P J' for a covariance P and any J of the shape above. Units of x squared.
template <class Scalar>
[[gnu::always_inline]] inline SymmetricMatrix3<Scalar> propagate_covariance(
    const SymmetricMatrix3<Scalar>& P, const TransitionJacobian<Scalar>& J) {
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

/// P + Q for a covariance P and a diagonal Q. Units of x squared.
template <class Scalar>
[[gnu::always_inline]] inline void add_process_noise(SymmetricMatrix3<Scalar>& P,
                                                     const Vector3<Scalar>& process_variance) {
  P(kPosition, kPosition) += process_variance[kPosition];
  P(kVelocity, kVelocity) += process_variance[kVelocity];
  P(kThird, kThird) += process_variance[kThird];
}

/// J P J' + Q for a covariance P and a diagonal Q (eq 20). Units of x squared.
template <class Scalar>
[[gnu::always_inline]] inline SymmetricMatrix3<Scalar> propagate_covariance(
    const SymmetricMatrix3<Scalar>& P, const TransitionJacobian<Scalar>& J,
    const Vector3<Scalar>& process_variance) {
  SymmetricMatrix3<Scalar> predicted = propagate_covariance(P, J);
  add_process_noise(predicted, process_variance);
  return predicted;
}

/// Covariance after v <- vv v + vx x.
template <class Scalar>
[[gnu::always_inline]] inline void step_velocity(SymmetricMatrix3<Scalar>& P, Scalar vv,
                                                 Scalar vx) {
  enum { p = kPosition, v = kVelocity, x = kThird };
  const Scalar row_v = vv * P(v, v) + vx * P(v, x);
  P(v, x) = vv * P(v, x) + vx * P(x, x);
  P(v, v) = vv * row_v + vx * P(v, x);
  P(p, v) = vv * P(p, v) + vx * P(p, x);
}

/// Covariance after p <- p + T v; T in s.
template <class Scalar>
[[gnu::always_inline]] inline void step_position(SymmetricMatrix3<Scalar>& P, Scalar T) {
  enum { p = kPosition, v = kVelocity, x = kThird };
  const Scalar P_pv = P(p, v);
  P(p, x) += T * P(v, x);
  P(p, v) += T * P(v, v);
  P(p, p) += T * (P_pv + P(p, v));
}

/// Effect of a scalar measurement on the covariance, and the gain for the state.
template <class Scalar>
struct ScalarGain {
  Vector3<Scalar> K = Vector3<Scalar>::Zero();
  Scalar inverse_S = 0;  ///< 1 / innovation variance; 0 if refused
  bool refused = false;  ///< S was not positive and finite: the covariance is untouched
};

/// Updates `P` for a measurement of state `i` with variance `R` (eqs 21, 23).
template <int i, class Scalar>
[[nodiscard, gnu::always_inline]] inline ScalarGain<Scalar> update_covariance(
    SymmetricMatrix3<Scalar>& P, Scalar R) {
  const Scalar S = P(i, i) + R;
  ScalarGain<Scalar> gain;
  if (!(S > S - S)) [[unlikely]] {  // S - S is 0, or NaN if S is not finite
    gain.refused = true;
    return gain;
  }
  constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
  gain.inverse_S = Scalar(1) / S;
  gain.K[i] = P(i, i) * gain.inverse_S;
  gain.K[j] = P(j, i) * gain.inverse_S;
  gain.K[k] = P(k, i) * gain.inverse_S;
  P(j, j) -= gain.K[j] * P(j, i);
  P(j, k) -= gain.K[j] * P(k, i);
  P(k, k) -= gain.K[k] * P(k, i);
  P(i, i) = gain.K[i] * R;
  P(j, i) = gain.K[j] * R;
  P(k, i) = gain.K[k] * R;
  return gain;
}

/// Result of one scalar measurement.
template <class Scalar>
struct ScalarUpdate {
  Scalar innovation{};  ///< z - x_i before the update, unit of the measured state
  /// innovation^2 / S: chi-square with 1 degree of freedom if the model holds; NaN if refused
  Scalar nis = std::numeric_limits<Scalar>::quiet_NaN();
  bool refused = false;  ///< S was not positive and finite: state and covariance are untouched
};

/// State and covariance of one stage, with the two operations of the extended Kalman filter.
template <class Scalar>
struct ThreeStateFilter {
  Vector3<Scalar> x = Vector3<Scalar>::Zero();
  SymmetricMatrix3<Scalar> P;

  ThreeStateFilter() = default;
  [[gnu::always_inline]] ThreeStateFilter(const ThreeStateFilter&) = default;
  [[gnu::always_inline]] ThreeStateFilter& operator=(const ThreeStateFilter&) = default;

  /// Starts at state `x0` with independent errors of variances `initial_variance`.
  void initialise(const Vector3<Scalar>& x0, const Vector3<Scalar>& initial_variance) {
    x = x0;
    P = SymmetricMatrix3<Scalar>::diagonal(initial_variance);
  }

  /// Moves state and covariance along `transition` (eq 20).
  [[gnu::always_inline]] void predict(const Transition<Scalar>& transition,
                                      const Vector3<Scalar>& process_variance) {
    x = transition.state;
    P = propagate_covariance(P, transition.jacobian, process_variance);
  }

  /// The same for a backward Euler step of length `T` (s): new velocity first, then position.
  [[gnu::always_inline]] void predict_backward(const Transition<Scalar>& transition, Scalar T,
                                               const Vector3<Scalar>& process_variance) {
    x = transition.state;
    step_velocity(P, transition.jacobian.vv, transition.jacobian.vx);
    step_position(P, T);
    add_process_noise(P, process_variance);
  }

  /// Normalised innovation squared that a measurement `z` of state `i` with variance `R` would
  /// have.
  template <int i>
  [[nodiscard, gnu::always_inline]] Scalar nis_of(Scalar z, Scalar R) const {
    const Scalar innovation = z - x[i];
    return innovation * (innovation * (Scalar(1) / (P(i, i) + R)));
  }

  /// Uses the measurement `z` of state `i` with variance `R` (eqs 21-23). Nothing is changed if S
  /// is not positive and finite; the caller reports it.
  template <int i>
  [[nodiscard, gnu::always_inline]] ScalarUpdate<Scalar> update(Scalar z, Scalar R) {
    const ScalarGain<Scalar> gain = update_covariance<i>(P, R);
    ScalarUpdate<Scalar> result;
    result.innovation = z - x[i];
    result.refused = gain.refused;
    if (gain.refused) [[unlikely]]
      return result;
    result.nis = result.innovation * (result.innovation * gain.inverse_S);
    x += gain.K * result.innovation;
    return result;
  }
};

}  // namespace condyle
