// SPDX-License-Identifier: Apache-2.0
// Parameters of the recommended estimator of motion: plain structs, each field with its default,
// meaning and unit. `visit_motion_fields` is the one list of their names and ranges; loading,
// saving and checking walk it.
#pragma once

#include <cstddef>

#include "condyle/estimator/parameter_range.h"

namespace condyle {

/// Whether noise and jerk density are estimated.
enum class Adaptation { off, on };

/// Noise of the instrument and jerk density of the motion. With adaptation on, `position_sd_m` and
/// `rotation_sd_rad` are first guesses and `jerk_density_m2_s5` is not used.
struct NoiseParameters {
  Adaptation adaptation = Adaptation::on;
  double position_sd_m = 5e-5;          ///< noise of a measured position (m)
  double rotation_sd_rad = 2e-3;        ///< noise of the jaw's orientation, from three points (rad)
  double jerk_density_m2_s5 = 10;       ///< spectral density of the jerk (m^2/s^5)
  double memory_s = 8;                  ///< time over which noise is averaged (s)
  double lowest_position_sd_m = 1e-6;   ///< floor of the estimated noise (m)
  double highest_position_sd_m = 5e-3;  ///< ceiling of the estimated noise (m)
};

/// The prior of a jaw's motion before the first sample, and again after a restart.
struct MotionPriorParameters {
  double velocity_sd_m_s = 0.1;       ///< of the velocity, mean 0 (m/s)
  double acceleration_sd_m_s2 = 2.0;  ///< of the acceleration, mean 0 (m/s^2)
};

/// When a sample counts less, and when the filter restarts (outlier_gate.h).
struct OutlierParameters {
  double huber_sd = 3;     ///< deviation from which on a sample counts less (sd)
  double gate_sd = 6;      ///< deviation from which on it is rejected (sd)
  double reset_after = 5;  ///< samples in a row that fit no hypothesis before the filter restarts
  double longest_gap_s = 0.25;  ///< time without a measurement after which the state is unknown (s)
};

/// The recommended estimator of motion. Time steps come from the samples' times.
struct MotionEstimatorParameters {
  double assumed_mass_kg = 0.25;  ///< m0, mass that turns acceleration into force (kg)
  NoiseParameters noise;
  MotionPriorParameters prior;
  OutlierParameters outliers;
};

/// Calls `visit(section, key, values, count, unit, range)` for each numeric field of `parameters`
/// in the order of the file format; `section` is "" at the top level. `Parameters` is
/// MotionEstimatorParameters, const or not.
template <class Parameters, class Visitor>
constexpr void visit_motion_fields(Parameters& parameters, Visitor&& visit) {
  constexpr Range noise_range{1e-7, 0.1};
  const auto one = [&visit](const char* section, const char* key, auto& value, const char* unit,
                            Range range) {
    visit(section, key, &value, std::size_t{1}, unit, range);
  };
  one("", "assumed_mass_kg", parameters.assumed_mass_kg, "kg", Range{1e-6, 100});
  auto& noise = parameters.noise;
  one("noise", "position_sd_m", noise.position_sd_m, "m", noise_range);
  one("noise", "rotation_sd_rad", noise.rotation_sd_rad, "rad", Range{0, 1});
  one("noise", "jerk_density_m2_s5", noise.jerk_density_m2_s5, "m^2/s^5", Range{1e-6, 1e6});
  one("noise", "memory_s", noise.memory_s, "s", Range{0.5, 3600});
  one("noise", "lowest_position_sd_m", noise.lowest_position_sd_m, "m", noise_range);
  one("noise", "highest_position_sd_m", noise.highest_position_sd_m, "m", noise_range);
  auto& prior = parameters.prior;
  one("prior", "velocity_sd_m_s", prior.velocity_sd_m_s, "m/s", Range{1e-3, 1});
  one("prior", "acceleration_sd_m_s2", prior.acceleration_sd_m_s2, "m/s^2", Range{1e-2, 100});
  auto& outliers = parameters.outliers;
  one("outliers", "huber_sd", outliers.huber_sd, "standard deviations", Range{1, 100});
  one("outliers", "gate_sd", outliers.gate_sd, "standard deviations", Range{1, 1000});
  one("outliers", "reset_after", outliers.reset_after, "samples", Range{1, 1000});
  one("outliers", "longest_gap_s", outliers.longest_gap_s, "s", Range{1e-3, 10});
}

/// True if every field of `parameters` is in its range (see `visit_motion_fields`) and the
/// combination is valid: lowest below highest noise, Huber's limit not above the gate's.
constexpr bool is_valid(const MotionEstimatorParameters& parameters) {
  bool valid = parameters.noise.lowest_position_sd_m < parameters.noise.highest_position_sd_m &&
               parameters.outliers.huber_sd <= parameters.outliers.gate_sd;
  visit_motion_fields(
      parameters, [&valid](const char*, const char*, const double* values, std::size_t, const char*,
                           Range range) { valid = valid && range.contains(*values); });
  return valid;
}

}  // namespace condyle
