// SPDX-License-Identifier: Apache-2.0
// Parameters of the damping of single chewing cycles and of the detector of a change of it.
// `visit_change_fields` is the one list of names and ranges.
#pragma once

#include <cstddef>

#include "condyle/estimator/parameter_range.h"

namespace condyle {

/// Properties of the point found over a baseline period and assumed from then on. Errors as large
/// as those of an identification over 60 s do not matter: each cycle treats the last three as
/// unknown again, and the detector learns the level of the first itself.
struct DampingBaseline {
  double friction_Ns_m = 0.05;
  double mass_kg = 0.25;
  double stiffness_N_m = 0;
  double offset_N = 0;
};

/// What counts as a chewing cycle.
struct CycleParameters {
  double travel_m = 0.002;        ///< it rises and falls by at least this (m)
  double shortest_s = 0.25;       ///< it takes at least this (s)
  double longest_s = 3;           ///< and at most this (s); above 0.3 Hz
  double longest_gap_s = 0.1;     ///< between samples (s); after a longer one the place is unknown
  double share_not_taken = 0.1;   ///< largest share of positions missing or beyond the gate
  double largest_sd_Ns_m = 0.25;  ///< of its damping; a cycle with a larger one does not count
};

/// The detector of a change.
struct ChangeParameters {
  /// The smallest lasting change that matters (Ns/m), up or down. The default is best for the
  /// change from 0.022 to 0.088 Ns/m, and not much worse for half or twice that change.
  double change_Ns_m = 0.05;
  /// Cycles between two false alarms, on average. The default is 8 h at 1.3 Hz.
  double false_alarm_cycles = 37440;
  /// Cycles for learning before the first is judged; 78 are 60 s at 1.3 Hz. False alarms are as
  /// rare with any number. With 78 the change from 0.022 to 0.088 Ns/m takes a cycle longer than
  /// with 390, and a change below change_Ns_m may be learned rather than detected.
  double baseline_cycles = 78;
};

/// All assumptions of a watch for changes.
struct WatchParameters {
  /// Time over which the point is identified before the first cycle (s).
  double identification_s = 60;
  CycleParameters cycles;
  ChangeParameters detector;
};

/// Calls `visit(section, key, values, count, unit, range)` for each field of `parameters`;
/// `Parameters` is CycleParameters, const or not.
template <class Parameters, class Visitor>
constexpr void visit_cycle_fields(Parameters& parameters, Visitor&& visit) {
  const auto one = [&visit](const char* key, auto& value, const char* unit, Range range) {
    visit("changes", key, &value, std::size_t{1}, unit, range);
  };
  one("travel_m", parameters.travel_m, "m", Range{1e-6, 1});
  one("shortest_s", parameters.shortest_s, "s", Range{0, 0.5});
  one("longest_s", parameters.longest_s, "s", Range{0.5, 100});
  one("longest_gap_s", parameters.longest_gap_s, "s", Range{1e-6, 1});
  one("share_not_taken", parameters.share_not_taken, "of a cycle's positions", Range{0, 1});
  one("largest_sd_Ns_m", parameters.largest_sd_Ns_m, "Ns/m", Range{1e-9, 1e6});
}

/// The same for ChangeParameters, without `false_alarm_cycles`: how often false alarms are
/// acceptable depends on the user, not on the file.
template <class Parameters, class Visitor>
constexpr void visit_detector_fields(Parameters& parameters, Visitor&& visit) {
  const auto one = [&visit](const char* key, auto& value, const char* unit, Range range) {
    visit("changes", key, &value, std::size_t{1}, unit, range);
  };
  one("change_Ns_m", parameters.change_Ns_m, "Ns/m", Range{1e-9, 1e6});
  one("baseline_cycles", parameters.baseline_cycles, "cycles", Range{10, 1e6});
}

/// The same for WatchParameters, in the order of the file format.
template <class Parameters, class Visitor>
constexpr void visit_change_fields(Parameters& parameters, Visitor&& visit) {
  visit("changes", "identification_s", &parameters.identification_s, std::size_t{1}, "s",
        Range{1, 1e5});
  visit_detector_fields(parameters.detector, visit);
  visit_cycle_fields(parameters.cycles, visit);
}

namespace internal {

// Visits fields, and returns whether all of them are in their ranges.
struct RangeCheck {
  bool valid = true;
  constexpr void operator()(const char*, const char*, const double* values, std::size_t,
                            const char*, Range range) {
    valid = valid && range.contains(*values);
  }
};

}  // namespace internal

/// True if every parameter is in its range.
constexpr bool is_valid(const DampingBaseline& baseline) {
  constexpr Range any{-1e6, 1e6};
  return any.contains(baseline.friction_Ns_m) && Range{1e-6, 100}.contains(baseline.mass_kg) &&
         any.contains(baseline.stiffness_N_m) && any.contains(baseline.offset_N);
}
/// True if every parameter is in its range.
constexpr bool is_valid(const CycleParameters& parameters) {
  internal::RangeCheck check;
  visit_cycle_fields(parameters, check);
  return check.valid;
}
/// True if every parameter is in its range.
constexpr bool is_valid(const ChangeParameters& parameters) {
  internal::RangeCheck check;
  visit_detector_fields(parameters, check);
  return check.valid && Range{100, 1e9}.contains(parameters.false_alarm_cycles);
}
/// True if every parameter is in its range.
constexpr bool is_valid(const WatchParameters& parameters) {
  internal::RangeCheck check;
  visit_change_fields(parameters, check);
  return check.valid && is_valid(parameters.detector);
}

}  // namespace condyle
