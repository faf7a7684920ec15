// SPDX-License-Identifier: Apache-2.0
// Compares an estimator with the truth of a simulated subject, over many seeds.
//
// Published cascade only: verdicts, and the posterior Cramer-Rao bound of stage 1's own model,
// reached only if the motion follows that model.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "evaluation/evaluation_run.h"
#include "evaluation/response_slope.h"
#include "statistics/monte_carlo.h"

namespace condyle::host {

/// How the runs differ: one variant for each factor of the subject's friction and mass; runs with
/// the same task and noise are successive.
struct EvaluationPlan {
  std::uint64_t runs = 40;
  std::uint64_t first_seed = 1;
  std::vector<double> friction_factors = {1};
  std::vector<double> mass_factors = {1};
};

/// The innovations along one axis, of all runs.
struct InnovationStatistics {
  ConsistencyStatistics nis{1, ConsistencyStatistics::Independent::terms};
  Moments correlation;  ///< of neighbours, one value for each run
};

/// Friction or mass at the ends of the runs.
struct IdentifiedStatistics {
  Moments error;      ///< of the fitted value, shown or not; its square is the part of the bias
  Moments square;     ///< of these errors
  Moments fitted_sd;  ///< that it stated
  std::uint64_t shown = 0;                               ///< as measured
  std::uint64_t covered = 0;                             ///< of these, by the 95 % interval
  std::array<std::uint64_t, kImpedanceLimits> limits{};  ///< why not
};

/// All runs.
struct Evaluation {
  std::array<ErrorStatistics, kEvaluatedQuantities> errors;
  std::array<std::uint64_t, kEvaluatedQuantities> not_computed{};
  ErrorOverTime velocity_m_s;
  int innovation_axes = 0;  ///< 1 or 3
  std::array<InnovationStatistics, 3> innovations;
  ConsistencyStatistics nees{3, ConsistencyStatistics::Independent::runs};
  std::uint64_t identified = 0;  ///< runs with a drive
  IdentifiedStatistics identified_friction, identified_mass;
  std::uint64_t samples = 0;
  EventCounts events;
  ResponseSlope friction_slope, mass_slope;
  std::vector<ResponsePair> friction, mass;  ///< one for each run, for the figures
  std::array<std::uint64_t, 3> verdicts{};
  /// Standard deviations that the bound allows, each in its quantity's unit; NaN: no bound.
  std::array<double, kEvaluatedQuantities> bound{};

  /// True if a quantity was computed at any sample.
  bool is_computed(EvaluatedIndex quantity) const {
    return errors[quantity].report(kNominalCoverage).samples > 0;
  }
};

/// Receives the share of the work that is done, 0 to 1, on the calling thread.
using EvaluationProgress = std::function<void(double share)>;

/// A block of the runs of a plan: shard `number` of `count`, from 1.
struct EvaluationShard {
  std::uint64_t number = 1, count = 1;
  /// The first of its runs, and the one after its last, of `runs`.
  std::uint64_t begin(std::uint64_t runs) const { return part(number - 1, runs); }
  std::uint64_t end(std::uint64_t runs) const { return part(number, runs); }

 private:
  std::uint64_t part(std::uint64_t shards, std::uint64_t runs) const {
    return runs / count * shards + std::min(shards, runs % count);
  }
};

/// The evaluation before its first run.
Evaluation empty_evaluation(const EstimatorSettings& settings);
/// Adds a run. The runs must come in their order.
void add_run(const EvaluationRun& run, Evaluation& evaluation);
/// Throws InputError, in the name of `scenario`, if no sample of any run was compared.
void refuse_nothing_compared(const std::string& scenario, const Evaluation& evaluation);

/// Calls `take` with each run of the shard, in order; otherwise as evaluate_estimator.
void evaluate_shard(const Scenario& scenario, const EstimatorSettings& settings,
                    const EvaluationPlan& plan, const EvaluationShard& shard,
                    const std::function<void(const EvaluationRun&)>& take,
                    const EvaluationProgress& progress = {}, MonteCarloControl control = {});

/// All runs of `plan`, on all cores; the result does not depend on their number. `control` as in
/// run_monte_carlo; every thread calls its `stop`. Throws InputError if no sample of any run could
/// be compared.
Evaluation evaluate_estimator(const Scenario& scenario, const EstimatorSettings& settings,
                              const EvaluationPlan& plan, const EvaluationProgress& progress = {},
                              MonteCarloControl control = {});

}  // namespace condyle::host
