// SPDX-License-Identifier: Apache-2.0
// Parameters of the identification: assumptions before the first sample and about the drive.
// `visit_impedance_fields` is the one list of their names and ranges.
#pragma once

#include <limits>

#include "condyle/estimator/published/parameters.h"

namespace condyle {

/// A value before any measurement, and how it may change (its unit is the name's).
struct ImpedancePrior {
  double mean = 0;
  double sd = 1;
  double walk_per_root_s = 0;  ///< standard deviation gained in a second; 0: a constant
};

/// How the measured drive relates to the true one. Systematic errors enter the intervals and are
/// never fitted: u = g F + missing has one scale too many for m, kv and g together.
struct DriveParameters {
  double noise_sd_N = 0.01;      ///< white, of each sample (N)
  double gain_sd = 0.01;         ///< relative uncertainty of its calibration
  double position_scale_sd = 0;  ///< relative uncertainty of the scale of the positions
  double axis_angle_sd_rad = 0;  ///< of the angle between its axis and that of the positions (rad)
  double delay_s = 0;            ///< how late the drive's samples are stamped (s)
  double delay_sd_s = 0.005;     ///< uncertainty of that (s)
  /// Share of the total force that it may miss, 0 to 1. The default 1 means unknown: nothing that
  /// needs the total drive is then called measured.
  double missing_share = 1;
  double longest_gap_s = 0.05;  ///< between its samples; it is unknown in a longer one (s)
};

/// Largest missing force relative to the measured one, if the drive may miss `share` (0 to 1) of
/// the total; infinite for 1.
constexpr double missing_over_measured(double share) {
  return share < 1 ? share / (1 - share) : std::numeric_limits<double>::infinity();
}

/// Whether the drive's delay is taken as stated, with its uncertainty widening the intervals, or is
/// estimated with the other values, starting from the stated one.
enum class DelayModel { known, fitted };

/// Whether the mass is the prior's, or is estimated with the other values.
enum class MassModel { known, fitted };

/// The identification of mass, damping and stiffness.
struct ImpedanceParameters {
  ImpedancePrior friction_Ns_m{0.05, 0.5, 0};
  ImpedancePrior mass_kg{0.25, 0.25, 0};
  MassModel mass = MassModel::fitted;
  ImpedancePrior stiffness_N_m{0, 50, 0};
  ImpedancePrior offset_N{0, 1, 0};
  /// Coulomb friction; with sd 0 there is none. For Coulomb friction alone, give the viscous
  /// friction the mean 0 and the lowest sd.
  ImpedancePrior coulomb_N{0, 0, 0};
  double coulomb_velocity_m_s = 0.005;  ///< range in which it changes its sign, smoothly (m/s)
  DelayModel delay = DelayModel::known;
  /// Of the detection of changes only: velocity, unmeasured force and gate.
  double velocity_sd_m_s = 0.1;     ///< of the velocity before the first sample (m/s)
  double force_noise_N_root_s = 0;  ///< white unmeasured force (N s^0.5)
  double gate_sd = 6;               ///< largest deviation of a position (sd)
  /// Positions above and below these are not used: teeth or food may touch there, with an
  /// unmeasured force (m, of the followed axis).
  double contact_above_m = 1e3, contact_below_m = -1e3;
  double least_velocity_m_s =
      0.002;  ///< rms of a second; a slower point only shows its place (m/s)
  /// The smallest differences that matter to the user. A value is measured if its standard
  /// deviation is at most half of them.
  double friction_resolution_Ns_m = 0.1;
  double mass_resolution_fraction = 0.05;
  /// The masses that a jaw, with everything fixed to it, may have (kg). Another mass indicates a
  /// wrong unit, and nothing is measured then.
  double least_mass_kg = 0.03, most_mass_kg = 3;
  DriveParameters drive;
};

/// Calls `visit(section, key, values, count, unit, range)` for each numeric field of `parameters`
/// in the order of the file format; `Parameters` is ImpedanceParameters, const or not.
template <class Parameters, class Visitor>
constexpr void visit_impedance_fields(Parameters& parameters, Visitor&& visit) {
  const auto one = [&visit](const char* section, const char* key, auto& value, const char* unit,
                            Range range) {
    visit(section, key, &value, std::size_t{1}, unit, range);
  };
  auto& drive = parameters.drive;
  one("drive", "noise_sd_N", drive.noise_sd_N, "N", Range{1e-9, 1e3});
  one("drive", "gain_sd", drive.gain_sd, "of the gain", Range{0, 1});
  one("drive", "position_scale_sd", drive.position_scale_sd, "of the scale", Range{0, 1});
  one("drive", "axis_angle_sd_rad", drive.axis_angle_sd_rad, "rad", Range{0, 1});
  one("drive", "delay_s", drive.delay_s, "s", Range{-1, 1});
  one("drive", "delay_sd_s", drive.delay_sd_s, "s", Range{0, 1});
  one("drive", "missing_share", drive.missing_share, "of the force", Range{0, 1});
  one("drive", "longest_gap_s", drive.longest_gap_s, "s", Range{1e-4, 10});
  const char* const section = "identification";
  constexpr Range mean_range{-1e6, 1e6}, sd_range{1e-9, 1e6}, walk_range{0, 1e6};
  auto& friction = parameters.friction_Ns_m;
  one(section, "friction_Ns_m", friction.mean, "Ns/m", mean_range);
  one(section, "friction_sd_Ns_m", friction.sd, "Ns/m", sd_range);
  one(section, "friction_walk_Ns_m_root_s", friction.walk_per_root_s, "Ns/m per root s",
      walk_range);
  auto& mass = parameters.mass_kg;
  one(section, "mass_kg", mass.mean, "kg", Range{1e-6, 100});
  one(section, "mass_sd_kg", mass.sd, "kg", sd_range);
  one(section, "mass_walk_kg_root_s", mass.walk_per_root_s, "kg per root s", walk_range);
  auto& stiffness = parameters.stiffness_N_m;
  one(section, "stiffness_N_m", stiffness.mean, "N/m", mean_range);
  one(section, "stiffness_sd_N_m", stiffness.sd, "N/m", sd_range);
  one(section, "stiffness_walk_N_m_root_s", stiffness.walk_per_root_s, "N/m per root s",
      walk_range);
  auto& offset = parameters.offset_N;
  one(section, "offset_N", offset.mean, "N", mean_range);
  one(section, "offset_sd_N", offset.sd, "N", sd_range);
  one(section, "offset_walk_N_root_s", offset.walk_per_root_s, "N per root s", walk_range);
  auto& coulomb = parameters.coulomb_N;
  one(section, "coulomb_N", coulomb.mean, "N", mean_range);
  one(section, "coulomb_sd_N", coulomb.sd, "N", Range{0, 1e6});
  one(section, "coulomb_walk_N_root_s", coulomb.walk_per_root_s, "N per root s", walk_range);
  one(section, "coulomb_velocity_m_s", parameters.coulomb_velocity_m_s, "m/s", Range{1e-6, 10});
  one(section, "velocity_sd_m_s", parameters.velocity_sd_m_s, "m/s", Range{1e-6, 100});
  one(section, "force_noise_N_root_s", parameters.force_noise_N_root_s, "N s^0.5", Range{0, 1e3});
  one(section, "gate_sd", parameters.gate_sd, "standard deviations", Range{1, 1000});
  one(section, "contact_above_m", parameters.contact_above_m, "m", Range{-1e3, 1e3});
  one(section, "contact_below_m", parameters.contact_below_m, "m", Range{-1e3, 1e3});
  one(section, "least_velocity_m_s", parameters.least_velocity_m_s, "m/s", Range{0, 10});
  one(section, "friction_resolution_Ns_m", parameters.friction_resolution_Ns_m, "Ns/m",
      Range{1e-9, 1e6});
  one(section, "mass_resolution_fraction", parameters.mass_resolution_fraction, "of the mass",
      Range{1e-6, 1});
  one(section, "least_mass_kg", parameters.least_mass_kg, "kg", Range{0, 1e6});
  one(section, "most_mass_kg", parameters.most_mass_kg, "kg", Range{1e-6, 1e9});
}

/// True if every field of `parameters` is in its range (see `visit_impedance_fields`).
constexpr bool is_valid(const ImpedanceParameters& parameters) {
  bool valid = true;
  visit_impedance_fields(
      parameters, [&valid](const char*, const char*, const double* values, std::size_t, const char*,
                           Range range) { valid = valid && range.contains(*values); });
  return valid;
}

}  // namespace condyle
