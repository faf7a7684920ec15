// SPDX-License-Identifier: Apache-2.0
// Stage 3 of the published cascade: mass from stage 1's force and velocity and stage 2's friction.
//
//   p, v, m   position (m), velocity (m/s), mass (kg); the state
//   T         sample time (s)
//   u, kv     inputs: stage 1's net force (N) and stage 2's friction (Ns/m), after their updates
//   z         measured position (m); second measurement: stage 1's velocity after its update (m/s)
//
// Model, eq (15):        p' = v,  v' = (u - kv v) / m,  m' = 0
// Backward Euler, eqs (47)-(49):
//                        v <- (m v + T u) / (m + T kv),  p <- p + T v_new,  m <- m
//                        and the same with one product less: v <- v - T (kv v - u) / (m + T kv)
// Jacobian (48 is garbled in print; this is the derivative of the line above):
//                        dv/dv = m / (m + T kv)
//                        dv/dm = T (kv v - u) / (m + T kv)^2
//                        the p row is T times the v row, plus 1 for p
// Measurements:          z = p,  v
//
// u presupposes the mass m0, so m = m0 solves this model for every motion: the value found is the
// assumption itself.
#pragma once

#include "condyle/estimator/math/three_state_filter.h"

namespace condyle {

/// Transition of (position m, velocity m/s, mass kg) under the inputs `force_N` and
/// `friction_Ns_m`, eqs (47)-(49).
template <class Scalar>
[[gnu::always_inline]] inline Transition<Scalar> mass_transition(const Vector3<Scalar>& x,
                                                                 Scalar force_N,
                                                                 Scalar friction_Ns_m,
                                                                 Scalar sample_time_s) {
  const Scalar T = sample_time_s;
  const Scalar m = x[kThird], v = x[kVelocity], u = force_N, kv = friction_Ns_m;
  const Scalar inverse_denominator = Scalar(1) / (m + T * kv);
  const Scalar dv_dv = m * inverse_denominator;
  const Scalar loss = T * inverse_denominator * (kv * v - u);
  const Scalar v_next = v - loss;
  const Scalar dv_dm = loss * inverse_denominator;
  return {.state = {x[kPosition] + T * v_next, v_next, m},
          .jacobian = {.pv = T * dv_dv, .px = T * dv_dm, .vv = dv_dv, .vx = dv_dm}};
}

}  // namespace condyle
