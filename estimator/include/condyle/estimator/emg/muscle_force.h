// SPDX-License-Identifier: Apache-2.0
// Force of a muscle from its excitation, and its component along the followed axis.
//
//   e, a      excitation and activation, share of the maximum
//   q, q'     coordinate of the jaw: opening angle (rad) of a hinge, displacement (m) of a
//             translation
//   z, J      followed coordinate (m), J = dz/dq
//   r         moment arm (m) of a hinge, cos(alpha) of a translation; positive: drives q up
//   l, w      fibre length / optimal length, its rate / 10 per second
//   F         force of the muscle (N)
//
// Followed:    hinge z = R (sin(phi0 - q) - sin phi0), eq 5, phi0 and R those of the incisor point;
//              translation z = q
// Activation:  a' = (e - a) / tau, tau 10 ms rising, 40 ms falling
// Force:       F = a F_max f_l f_v                                                (F_n of eq 1)
//                f_l = exp(-((l - 1) / 0.45)^2),  l = 1 - r q / l_opt
//                f_v = (1 + w) / (1 - w / 0.25) shortening, 0 at w <= -1; lengthening a hyperbola
//                of the same slope at w = 0 up to 1.4,  w = -r q' / l_opt / 10 per second
// Along z:     r F / J: moment arm over lever arm of eq 1, F cos(alpha) of eq 8; the gain K_n of
//              eqs 1 and 9 apart
//
// Equations of Bogena et al. 2022; force-length, force-velocity and activation after D. G. Thelen,
// J. Biomech. Eng. 125 (2003) 70-77, doi 10.1115/1.1531112. A force-velocity slope acts like
// friction: 5 F_max a r^2 / (10 l_opt J^2) Ns/m at rest.
#pragma once

#include <concepts>
#include <cstdint>

#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/math/elementary.h"

namespace condyle {

/// Most muscles supported.
inline constexpr std::size_t kMostMuscles = 8;

/// Kind of the jaw's motion.
enum class JawMotion : std::uint8_t { hinge, translation };

/// Converts the jaw's coordinate q to the followed one.
struct JawGeometry {
  JawMotion motion = JawMotion::hinge;
  double incisor_radius_m = 0.089;     ///< R of eq 5
  double incisor_angle_rad = -0.4887;  ///< phi0 of eq 5

  /// z (m) at `q`.
  template <class Scalar>
  Scalar position_m(Scalar q) const {
    if (motion == JawMotion::translation) return q;
    const Scalar phi0 = Scalar(incisor_angle_rad);
    return Scalar(incisor_radius_m) * (elementary::sin(phi0 - q) - elementary::sin(phi0));
  }
  /// J at `q`: m/rad of a hinge, 1 of a translation.
  template <class Scalar>
  Scalar slope(Scalar q) const {
    if (motion == JawMotion::translation) return Scalar(1);
    return -Scalar(incisor_radius_m) * elementary::cos(Scalar(incisor_angle_rad) - q);
  }
  /// q at which the followed coordinate is `position_m`; only if `reaches` is true.
  template <class Scalar>
  Scalar coordinate_at(Scalar position_m) const {
    if (motion == JawMotion::translation) return position_m;
    Scalar q = -position_m / Scalar(incisor_radius_m);
    for (int i = 0; i < 20; ++i) q -= (this->position_m(q) - position_m) / slope(q);
    return q;
  }
  /// True if the followed coordinate can be `position_m`, with some lever arm left.
  template <class Scalar>
  bool reaches(Scalar position_m) const {
    if (motion == JawMotion::translation) return position_m - position_m == Scalar(0);
    const Scalar sine =
        position_m / Scalar(incisor_radius_m) + elementary::sin(Scalar(incisor_angle_rad));
    return sine > Scalar(-0.95) && sine < Scalar(0.95);
  }
};

/// A muscle, or a left-right pair acting as one.
struct MuscleParameters {
  double maximum_force_N = 100;    ///< F_max
  double arm = 0.03;               ///< r
  double optimal_length_m = 0.04;  ///< l_opt
};

/// Force-length factor f_l at `q`, 0 to 1.
template <std::floating_point Scalar>
Scalar force_length_factor(const MuscleParameters& muscle, Scalar q) {
  constexpr double kWidth = 0.45;
  const Scalar stretch = -Scalar(muscle.arm) * q / Scalar(muscle.optimal_length_m) / Scalar(kWidth);
  return elementary::exp(-stretch * stretch);
}

/// Force-velocity factor f_v at `q_rate`, 0 (fastest shortening) to 1.4 (lengthening).
template <std::floating_point Scalar>
Scalar force_velocity_factor(const MuscleParameters& muscle, Scalar q_rate) {
  constexpr double kHillShape = 0.25, kLengtheningPlateau = 1.4, kMaximumLengthsPerSecond = 10;
  const Scalar w = -Scalar(muscle.arm) * q_rate / Scalar(muscle.optimal_length_m) /
                   Scalar(kMaximumLengthsPerSecond);
  if (w <= Scalar(-1)) return Scalar(0);
  if (w <= Scalar(0)) return (Scalar(1) + w) / (Scalar(1) - w / Scalar(kHillShape));
  const Scalar slope = Scalar(1 + 1 / kHillShape);  // that at w = 0
  const Scalar rise = Scalar(kLengtheningPlateau - 1);
  return Scalar(1) + rise * slope * w / (rise + slope * w);
}

/// Time constant (s) of an activation that approaches an excitation.
template <std::floating_point Scalar>
Scalar activation_time_s(Scalar activation, Scalar excitation) {
  return Scalar(excitation > activation ? 0.010 : 0.040);
}

/// Rate of change of an activation (1/s) towards `excitation`.
template <std::floating_point Scalar>
Scalar activation_rate(Scalar activation, Scalar excitation) {
  return (excitation - activation) / activation_time_s(activation, excitation);
}

/// The activation after `T` s of constant excitation.
template <std::floating_point Scalar>
Scalar activation_after(Scalar activation, Scalar excitation, Scalar T) {
  const Scalar left = elementary::exp(-T / activation_time_s(activation, excitation));
  return excitation + left * (activation - excitation);
}

/// F (N) of a muscle at coordinate `q`, rate `q_rate`.
template <std::floating_point Scalar>
Scalar muscle_force_N(const MuscleParameters& muscle, Scalar activation, Scalar q, Scalar q_rate) {
  return activation * Scalar(muscle.maximum_force_N) * force_length_factor(muscle, q) *
         force_velocity_factor(muscle, q_rate);
}

/// Force (N) along the followed axis, of gain 1, at coordinate `q`, rate `q_rate`.
template <std::floating_point Scalar>
Scalar followed_force_N(const JawGeometry& jaw, const MuscleParameters& muscle, Scalar activation,
                        Scalar q, Scalar q_rate) {
  return Scalar(muscle.arm) * muscle_force_N(muscle, activation, q, q_rate) / jaw.slope(q);
}

}  // namespace condyle
