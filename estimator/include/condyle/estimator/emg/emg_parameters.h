// SPDX-License-Identifier: Apache-2.0
// Parameters of the identification from EMG. `visit_emg_fields` is the one list of their names and
// ranges.
#pragma once

#include "condyle/estimator/published/parameters.h"

namespace condyle {

/// A value before any measurement; the name contains its unit.
struct EmgPrior {
  double mean = 0;
  double sd = 1;
};

/// The identification from EMG.
struct EmgParameters {
  EmgPrior mass_kg{0.2, 0.04};  ///< at the followed point; assumed, never fitted
  /// With an sd above about the mass / the positions' sampling interval the value cannot be found.
  EmgPrior friction_Ns_m{0.05, 20};
  EmgPrior stiffness_N_m{0, 50};
  EmgPrior offset_N{0, 5};
  EmgPrior gain{1, 1};  ///< K_n, of each muscle
  /// rms error of the muscles' force, as a share of that force; widens the intervals. EMG-driven
  /// models of the jaw: 0.28 to 0.46.
  double error_share = 0.46;
  double error_time_s = 0.2;     ///< correlation time of that error (s)
  double lag_s = 0;              ///< of the force behind its EMG, beyond that of the activation (s)
  double lag_sd_s = 0.03;        ///< uncertainty of that (s)
  double longest_gap_s = 0.05;   ///< of the EMG; it is unknown in a longer one (s)
  double velocity_sd_m_s = 0.1;  ///< of the velocity before the first sample (m/s)
  double gate_sd = 6;            ///< deviation from which on a position is rejected (sd)
  /// The smallest differences that matter to the user. A value is shown as derived if its standard
  /// deviation is at most half of them.
  double friction_resolution_Ns_m = 0.1;
  double gain_resolution = 0.5;
};

/// Calls `visit(key, value, unit, range)` for each field of `parameters`; `Parameters` is
/// EmgParameters, const or not.
template <class Parameters, class Visitor>
constexpr void visit_emg_fields(Parameters& parameters, Visitor&& visit) {
  constexpr Range mean_range{-1e6, 1e6}, sd_range{1e-9, 1e6};
  visit("mass_kg", parameters.mass_kg.mean, "kg", Range{1e-6, 100});
  visit("mass_sd_kg", parameters.mass_kg.sd, "kg", Range{0, 100});
  visit("friction_Ns_m", parameters.friction_Ns_m.mean, "Ns/m", mean_range);
  visit("friction_sd_Ns_m", parameters.friction_Ns_m.sd, "Ns/m", sd_range);
  visit("stiffness_N_m", parameters.stiffness_N_m.mean, "N/m", mean_range);
  visit("stiffness_sd_N_m", parameters.stiffness_N_m.sd, "N/m", sd_range);
  visit("offset_N", parameters.offset_N.mean, "N", mean_range);
  visit("offset_sd_N", parameters.offset_N.sd, "N", sd_range);
  visit("gain", parameters.gain.mean, "1", Range{1e-6, 1e6});
  visit("gain_sd", parameters.gain.sd, "1", sd_range);
  visit("error_share", parameters.error_share, "of the force", Range{1e-3, 10});
  visit("error_time_s", parameters.error_time_s, "s", Range{1e-3, 10});
  visit("lag_s", parameters.lag_s, "s", Range{-1, 1});
  visit("lag_sd_s", parameters.lag_sd_s, "s", Range{0, 1});
  visit("longest_gap_s", parameters.longest_gap_s, "s", Range{1e-4, 10});
  visit("velocity_sd_m_s", parameters.velocity_sd_m_s, "m/s", Range{1e-6, 100});
  visit("gate_sd", parameters.gate_sd, "standard deviations", Range{1, 1000});
  visit("friction_resolution_Ns_m", parameters.friction_resolution_Ns_m, "Ns/m", Range{1e-9, 1e6});
  visit("gain_resolution", parameters.gain_resolution, "1", Range{1e-6, 1e6});
}

/// True if every field of `parameters` is in its range (see `visit_emg_fields`).
constexpr bool is_valid(const EmgParameters& parameters) {
  bool valid = true;
  visit_emg_fields(parameters, [&valid](const char*, const double& value, const char*,
                                        Range range) { valid = valid && range.contains(value); });
  return valid;
}

}  // namespace condyle
