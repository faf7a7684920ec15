// SPDX-License-Identifier: Apache-2.0
// Parameters of the published cascade: plain structs, each field with its default, meaning and
// unit. `visit_fields` is the one list of their names and ranges; loading, saving and checking walk
// it.
#pragma once

#include <cstddef>
#include <limits>

#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/parameter_range.h"

namespace condyle {

/// How stage 1 turns eq (30) into steps.
enum class Discretisation { forward, backward };

/// Stage 1, state (position m, velocity m/s, net force N). Variances in those units squared.
struct MotionParameters {
  Discretisation discretisation = Discretisation::forward;  ///< Euler's form of eq (30)
  double initial_variance[3] = {1e-6, 0.01, 0.1};           ///< variance of the first state
  double process_variance[3] = {1e-12, 1e-8, 0.002};        ///< variance added by each step
  double measurement_variance[1] = {1e-8};                  ///< of the measured position (m^2)
};

/// Stage 2, state (position m, velocity m/s, friction Ns/m). Variances in those units squared.
struct FrictionParameters {
  double initial_Ns_m = 0.022;                        ///< friction before the first sample (Ns/m)
  double initial_variance[3] = {1e-6, 0.01, 1e-8};    ///< variance of the first state
  double process_variance[3] = {1e-12, 1e-8, 1e-12};  ///< variance added by each step
  double measurement_variance[2] = {1e-8, 1e-4};      ///< of position (m^2), of velocity (m^2/s^2)
};

/// Stage 3, state (position m, velocity m/s, mass kg). Variances in those units squared.
struct MassParameters {
  double initial_kg = 0.1;                            ///< mass before the first sample (kg)
  double initial_variance[3] = {1e-6, 0.01, 0.01};    ///< variance of the first state
  double process_variance[3] = {1e-12, 1e-8, 1e-10};  ///< variance added by each step
  double measurement_variance[2] = {1e-8, 1e-4};      ///< of position (m^2), of velocity (m^2/s^2)
};

/// The published cascade. It uses `sample_time_s`, not the timestamps of the samples.
struct PublishedParameters {
  double sample_time_s = 0.0167;  ///< T, time from sample to sample (s); the paper's 60 Hz
  double assumed_mass_kg = 0.25;  ///< m0, mass that turns acceleration into force (kg)
  MotionParameters motion;
  FrictionParameters friction;
  MassParameters mass;
};

/// Range of a measurement variance: zero would claim a perfect instrument.
inline constexpr Range kMeasurementVarianceRange{1e-30, 1e6};
/// Range of an initial or process variance; zero freezes the state.
inline constexpr Range kVarianceRange{0, 1e6};

/// Calls `visit(section, key, values, count, unit, range)` for each numeric field of `parameters`
/// in the order of the file format; `section` is "" at the top level. `Parameters` is
/// PublishedParameters, const or not.
template <class Parameters, class Visitor>
constexpr void visit_fields(Parameters& parameters, Visitor&& visit) {
  constexpr Range mass_range{1e-6, 100};
  constexpr const char* variances = "squares of the state's units";
  visit("", "sample_time_s", &parameters.sample_time_s, std::size_t{1}, "s", Range{1e-6, 10});
  visit("", "assumed_mass_kg", &parameters.assumed_mass_kg, std::size_t{1}, "kg", mass_range);
  const auto visit_variances = [&](const char* section, auto& stage) {
    visit(section, "initial_variance", &stage.initial_variance[0], std::size_t{3}, variances,
          kVarianceRange);
    visit(section, "process_variance", &stage.process_variance[0], std::size_t{3}, variances,
          kVarianceRange);
    visit(section, "measurement_variance", &stage.measurement_variance[0],
          sizeof stage.measurement_variance / sizeof(double), "squares of the measurements' units",
          kMeasurementVarianceRange);
  };
  visit_variances("motion", parameters.motion);
  visit("friction", "initial_Ns_m", &parameters.friction.initial_Ns_m, std::size_t{1}, "Ns/m",
        Range{0, 1e4});
  visit_variances("friction", parameters.friction);
  visit("mass", "initial_kg", &parameters.mass.initial_kg, std::size_t{1}, "kg", mass_range);
  visit_variances("mass", parameters.mass);
}

/// True if every field of `parameters` is in its range (see `visit_fields`).
constexpr bool is_valid(const PublishedParameters& parameters) {
  bool valid = true;
  visit_fields(parameters, [&valid](const char*, const char*, const double* values,
                                    std::size_t count, const char*, Range range) {
    for (std::size_t i = 0; i < count; ++i) valid = valid && range.contains(values[i]);
  });
  return valid;
}

}  // namespace condyle
