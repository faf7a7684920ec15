// SPDX-License-Identifier: Apache-2.0
// The jaw of the paper's section 2: a body with one degree of freedom q, and its muscles.
//
//   hinge        q = opening angle about the TMJ axis (rad). Followed: height of the incisor point,
//                z(q) = R (sin(phi0 - q) - sin phi0), eq (5): 0 with the teeth together, negative
//                when open. Inertia I about the axis; eqs (1)-(4), (3) corrected: theta <- theta +
//                omega dT + M / (2 I) dT^2.
//   translation  q = displacement (m) along the lateral or protrusive axis, followed as it is.
//                Inertia m; eqs (6)-(12): F_x = F cos(alpha).
//
// With J = dz/dq the body obeys  inertia q'' = sum of generalised forces;  a force F along z counts
// J F. Effective mass at the followed point: inertia / J^2.
//
// Muscle n: force F_n = activation x F_max x force-length x force-velocity (eq 1's F_n), the
// factors those of condyle/estimator/emg/muscle_force.h; generalised force K_n r_n F_n with r_n its
// moment arm (m; sign: positive drives q up) or cos(alpha_n).
#pragma once

#include <string>
#include <vector>

#include "condyle/estimator/emg/muscle_force.h"

namespace condyle::host {

/// One muscle (or a left-right pair acting as one).
struct Muscle {
  std::string name;
  double maximum_force_N = 100;
  double arm = 0.03;               ///< r_n: moment arm (m) of a hinge, cos(alpha) of a translation
  double optimal_length_m = 0.04;  ///< fibre length of greatest force
  double gain = 1;                 ///< K_n

  MuscleParameters parameters() const { return {maximum_force_N, arm, optimal_length_m}; }
};

using condyle::JawMotion;

/// A jaw.
struct Jaw {
  JawMotion motion = JawMotion::hinge;
  double mass_kg = 0.2;
  double inertia_kg_m2 = 9.7e-4;       ///< about the TMJ axis; hinge only
  double incisor_radius_m = 0.089;     ///< R of eq (5)
  double incisor_angle_rad = -0.4887;  ///< phi0 of eq (5)
  double centre_of_mass_radius_m =
      0.05;  ///< from the TMJ axis, along the line to the incisor point
  std::vector<Muscle> muscles;

  JawGeometry geometry() const { return {motion, incisor_radius_m, incisor_angle_rad}; }
  /// Inertia for q'': kg m^2 of a hinge, kg of a translation.
  double inertia() const { return motion == JawMotion::hinge ? inertia_kg_m2 : mass_kg; }
  /// Followed coordinate z (m) at q.
  double followed_position_m(double q) const;
  /// J = dz/dq: m/rad of a hinge, 1 of a translation.
  double followed_slope(double q) const;
  /// dJ/dq.
  double followed_curvature(double q) const;
  /// q at which the followed coordinate is `position_m`, within the hinge's range.
  double coordinate_at(double position_m) const;
  /// Generalised force of the weight at q.
  double weight(double q) const;
  /// Effective mass at the followed coordinate (kg).
  double effective_mass_kg(double q) const {
    const double J = followed_slope(q);
    return inertia() / (J * J);
  }
};

/// Force-length factor of `muscle` at coordinate q, 0 to 1.
double force_length_factor(const Muscle& muscle, double q);
/// Force-velocity factor at rate q', 0 (fastest shortening) to 1.4 (lengthening).
double force_velocity_factor(const Muscle& muscle, double q_rate);
using condyle::activation_rate;

/// The two subjects tabulated in the literature, opening and closing by muscles:
/// "artisynth" (lower ends of the published ranges of muscle force) or "anybody" (upper ends).
Jaw tabulated_hinge_jaw(const std::string& name);
/// The same subject's jaw moving along a lateral or protrusive axis.
Jaw tabulated_translation_jaw(const std::string& name);

}  // namespace condyle::host
