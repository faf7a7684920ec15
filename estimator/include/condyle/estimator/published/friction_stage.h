// SPDX-License-Identifier: Apache-2.0
// Stage 2 of the published cascade: friction from stage 1's force and velocity.
//
//   p, v, kv   position (m), velocity (m/s), friction (Ns/m); the state
//   T, m0      sample time (s), assumed mass (kg)
//   u          input: stage 1's net force after its update (N)
//   z          measured position (m); second measurement: stage 1's velocity after its update (m/s)
//
// Model, eq (13):        p' = v,  v' = (u - kv v) / m0,  kv' = 0
// Backward Euler, eqs (44)-(46), with d = 1 + T kv / m0:
//                        v <- (v + T u / m0) / d,  p <- p + T v_new,  kv <- kv
// Jacobian (46 is garbled in print; this is the derivative of the line above):
//                        dv/dv  = 1 / d
//                        dv/dkv = -(v + T u / m0) (T / m0) / d^2
//                        the p row is T times the v row, plus 1 for p
// Measurements:          z = p,  v
//
// u is m0 times the acceleration that stage 1 saw, so kv = 0 solves this model for every motion:
// the value found reflects the tuning of the filter, not the friction of the joint.
#pragma once

#include "condyle/estimator/math/three_state_filter.h"

namespace condyle {

/// Transition of (position m, velocity m/s, friction Ns/m) under the input `force_N`, eqs
/// (44)-(46).
template <class Scalar>
[[gnu::always_inline]] inline Transition<Scalar> friction_transition(const Vector3<Scalar>& x,
                                                                     Scalar force_N,
                                                                     Scalar sample_time_s,
                                                                     Scalar assumed_mass_kg) {
  const Scalar T = sample_time_s;
  const Scalar T_over_m0 = T / assumed_mass_kg;
  const Scalar inverse_d = Scalar(1) / (Scalar(1) + T_over_m0 * x[kThird]);
  const Scalar v_next = (x[kVelocity] + T_over_m0 * force_N) * inverse_d;
  const Scalar dv_dkv = -(T_over_m0 * inverse_d) * v_next;
  return {.state = {x[kPosition] + T * v_next, v_next, x[kThird]},
          .jacobian = {.pv = T * inverse_d, .px = T * dv_dkv, .vv = inverse_d, .vx = dv_dkv}};
}

}  // namespace condyle
