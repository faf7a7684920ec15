// SPDX-License-Identifier: Apache-2.0
// Compares one run of an estimator with the truth of a simulated subject.
//
// Each estimate is compared with the truth of the instant that it estimates: the true instant of
// its sample, independent of the lag and of the device's clock. The first fifth of the run is left
// out. Position, velocity and acceleration are compared with those of the followed coordinate, the
// only one whose truth the simulation has; the force with effective mass x acceleration; friction
// and mass with the effective ones at the followed point. A value that is not computed, or that is
// labelled assumed although a drive was measured, is counted but not compared. Innovations are
// those of every axis (stage 1's of the published cascade) that were not rejected.
//
// Published cascade only: its acceleration is stage 1's net force over the assumed mass; NEES is
// stage 1's (position, velocity, net force at the assumed mass) at the last sample.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <variant>

#include "condyle/estimator/events.h"
#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/published/matching_verdict.h"
#include "condyle/estimator/published/parameters.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "evaluation/consistency.h"
#include "evaluation/error_over_time.h"
#include "evaluation/error_statistics.h"
#include "simulation/simulation.h"

namespace condyle::host {

/// The recommended estimator and its lag in samples, 0 to 16.
struct RecommendedSettings {
  RecommendedParameters parameters;
  int lag = 0;
};

/// Which estimator is evaluated, and how it is set.
using EstimatorSettings = std::variant<RecommendedSettings, PublishedParameters>;

/// The quantities compared with their truth.
enum EvaluatedIndex : std::size_t {
  kPositionError,
  kVelocityError,
  kAccelerationError,
  kForceError,
  kFrictionError,
  kMassError,
};
inline constexpr std::size_t kEvaluatedQuantities = 6;
/// Name and unit of a quantity.
struct EvaluatedQuantity {
  const char* name;
  const char* unit;
};
inline constexpr EvaluatedQuantity kEvaluated[kEvaluatedQuantities] = {
    {"position", "m"}, {"velocity", "m/s"},  {"acceleration", "m/s^2"},
    {"force", "N"},    {"friction", "Ns/m"}, {"mass", "kg"}};

/// A true value and its estimate.
struct ResponsePair {
  double truth = std::numeric_limits<double>::quiet_NaN();
  double estimate = std::numeric_limits<double>::quiet_NaN();
};

/// The innovations along one axis.
struct RunInnovations {
  RunSquares nis;
  double correlation = std::numeric_limits<double>::quiet_NaN();  ///< of neighbours
};

/// Friction and mass at the end of a run with a measured drive.
struct IdentifiedRun {
  ImpedanceEstimate<double> last;
  double friction_Ns_m = 0, mass_kg = 0;  ///< mean truths
};

/// The result of one run.
struct EvaluationRun {
  std::array<RunErrors, kEvaluatedQuantities> errors;
  std::array<std::uint64_t, kEvaluatedQuantities> not_computed{};  ///< samples compared without it
  int innovation_axes = 0;                                         ///< 1 or 3
  std::array<RunInnovations, 3> innovations;
  RunSquares nees;
  ResponsePair friction, mass;              ///< mean truth, last estimate
  std::optional<Verdict> verdict;           ///< none: the estimator gives none
  std::optional<IdentifiedRun> identified;  ///< none: no drive was measured
  // Of the whole run:
  ErrorOverTime velocity_m_s;
  std::uint64_t samples = 0;
  EventCounts events;
};

/// One run of `scenario` with `seed` through the estimator; `should_stop`, asked at each sampling
/// instant, may end it early.
EvaluationRun evaluate_run(const Scenario& scenario, std::uint64_t seed,
                           const EstimatorSettings& settings,
                           const std::function<bool()>& should_stop = {});

}  // namespace condyle::host
