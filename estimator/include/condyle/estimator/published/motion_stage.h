// SPDX-License-Identifier: Apache-2.0
// Stage 1 of the published cascade: position, velocity and net force from the measured position.
//
//   p, v, F   position (m), velocity (m/s), net force (N); the state
//   T, m0     sample time (s), assumed mass (kg)
//   z         measured position (m)
//
// Model, eq (30):        p' = v,  v' = F / m0,  F' = 0
// Forward Euler:         p <- p + T v,                v <- v + T F / m0,  F <- F
// Backward Euler:        p <- p + T (v + T F / m0),   v <- v + T F / m0,  F <- F
// Jacobian (T^2 / m0 in the backward form only):
//                        | 1  T  [T^2 / m0] |
//                        | 0  1    T / m0   |
//                        | 0  0      1      |
// Measurement:           z = p
// The paper calls (30) forward in section 4 and backward in abstract and conclusion; both are here.
#pragma once

#include "condyle/estimator/math/three_state_filter.h"
#include "condyle/estimator/published/parameters.h"

namespace condyle {

/// Transition of (position m, velocity m/s, net force N) over `sample_time_s`, eq (30).
template <class Scalar>
[[gnu::always_inline]] inline Transition<Scalar> motion_transition(const Vector3<Scalar>& x,
                                                                   Scalar sample_time_s,
                                                                   Scalar assumed_mass_kg,
                                                                   Discretisation discretisation) {
  const Scalar T = sample_time_s;
  const Scalar T_over_m0 = T / assumed_mass_kg;
  const Scalar v_next = x[kVelocity] + T_over_m0 * x[kThird];
  const bool backward = discretisation == Discretisation::backward;
  const Scalar p_next = x[kPosition] + T * (backward ? v_next : x[kVelocity]);
  return {
      .state = {p_next, v_next, x[kThird]},
      .jacobian = {.pv = T, .px = backward ? T * T_over_m0 : Scalar(0), .vv = 1, .vx = T_over_m0}};
}

/// Covariance of the same step, with the process variances of one step (units of x squared).
template <class Scalar>
[[gnu::always_inline]] inline void propagate_motion_covariance(
    SymmetricMatrix3<Scalar>& P, Scalar sample_time_s, Scalar assumed_mass_kg,
    Discretisation discretisation, const Vector3<Scalar>& process_variance) {
  const Scalar T = sample_time_s;
  const Scalar T_over_m0 = T / assumed_mass_kg;
  if (discretisation == Discretisation::backward) {
    step_velocity(P, Scalar(1), T_over_m0);
    step_position(P, T);
  } else {
    step_position(P, T);
    step_velocity(P, Scalar(1), T_over_m0);
  }
  add_process_noise(P, process_variance);
}

}  // namespace condyle
