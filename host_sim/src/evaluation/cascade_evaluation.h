// SPDX-License-Identifier: Apache-2.0
// The published cascade against the truth of a simulated subject, over many seeds.
//
// The first fifth of each run is left out. Position and velocity are compared with the followed
// coordinate's, the force with effective mass x acceleration, friction and mass with the effective
// ones at the followed point. NEES is stage 1's (position, velocity, net force at the assumed mass)
// at the last sample of each run, one independent value a run; NIS is stage 1's at every sample.
// The bound is the posterior Cramer-Rao bound of stage 1's own model: reached where the motion is
// what that model says, and only there.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "condyle/estimator/matching_verdict.h"
#include "condyle/estimator/parameters.h"
#include "evaluation/consistency.h"
#include "evaluation/error_statistics.h"
#include "evaluation/monte_carlo.h"
#include "evaluation/response_slope.h"
#include "simulation/simulation.h"

namespace condyle::host {

/// The quantities compared with their truth.
inline constexpr std::size_t kEvaluatedQuantities = 5;
/// Name and unit of a quantity.
struct EvaluatedQuantity {
  const char* name;
  const char* unit;
};
inline constexpr EvaluatedQuantity kEvaluated[kEvaluatedQuantities] = {
    {"position", "m"}, {"velocity", "m/s"}, {"force", "N"}, {"friction", "Ns/m"}, {"mass", "kg"}};

/// A true value and what was found.
struct ResponsePair {
  double truth = std::numeric_limits<double>::quiet_NaN();
  double estimate = std::numeric_limits<double>::quiet_NaN();
};

/// One run.
struct EvaluationRun {
  std::array<RunErrors, kEvaluatedQuantities> errors;
  RunSquares nis, nees;
  ResponsePair friction, mass;  ///< mean truth, last estimate
  Verdict verdict = Verdict::not_matched;
};

/// How the runs differ: friction and mass of the subject are multiplied by these in turn; runs with
/// the same task and noise follow one another.
struct EvaluationPlan {
  std::uint64_t runs = 40;
  std::uint64_t first_seed = 1;
  std::vector<double> friction_factors = {1};
  std::vector<double> mass_factors = {1};
};

/// All runs.
struct Evaluation {
  std::array<ErrorStatistics, kEvaluatedQuantities> errors;
  ConsistencyStatistics nis{1, ConsistencyStatistics::Independent::terms};
  ConsistencyStatistics nees{3, ConsistencyStatistics::Independent::runs};
  ResponseSlope friction_slope, mass_slope;
  std::vector<ResponsePair> friction, mass;  ///< one a run, for the pictures
  std::array<std::uint64_t, 3> verdicts{};
  /// Standard deviations that the bound allows stage 1: position (m), velocity (m/s), force (N).
  std::array<double, 3> bound{};
};

/// One run of `scenario` with `seed` through the cascade; ends early where `stop` says so.
EvaluationRun evaluate_run(const Scenario& scenario, std::uint64_t seed,
                           const PublishedParameters& parameters,
                           const std::function<bool()>& stop = {});

/// All runs of `plan`, on all cores; the result does not depend on how many there are. `progress`
/// and `control` as in run_monte_carlo; its `stop` is asked by every thread. An InputError where no
/// sample of any run could be compared.
Evaluation evaluate_cascade(const Scenario& scenario, const PublishedParameters& parameters,
                            const EvaluationPlan& plan, const MonteCarloProgress& progress = {},
                            const MonteCarloControl& control = {});

}  // namespace condyle::host
