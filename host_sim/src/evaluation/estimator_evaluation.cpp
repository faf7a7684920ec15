// SPDX-License-Identifier: Apache-2.0
#include "evaluation/estimator_evaluation.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "condyle/estimator/published/published_cascade.h"
#include "evaluation/cramer_rao.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The bound after enough samples that it no longer changes.
std::array<double, kEvaluatedQuantities> bound_of_stage_1(const PublishedParameters& p) {
  const auto matrix = [](const double* variances) {
    return Eigen::Matrix3d(Eigen::Map<const Eigen::Vector3d>(variances).asDiagonal());
  };
  const auto transition = motion_transition<double>(Vector3<double>::Zero(), p.sample_time_s,
                                                    p.assumed_mass_kg, p.motion.discretisation);
  const auto& J = transition.jacobian;
  Eigen::Matrix3d F;
  F << 1, J.pv, J.px, 0, J.vv, J.vx, 0, 0, 1;
  BoundStep<3, 1> step(matrix(p.motion.process_variance),
                       Eigen::Matrix<double, 1, 1>(p.motion.measurement_variance[0]));
  step.add(F, Eigen::RowVector3d(1, 0, 0));
  Eigen::Matrix3d P = matrix(p.motion.initial_variance);
  for (int i = 0; i < 2000; ++i) P = step.advance_covariance(P);
  const double force_N = std::sqrt(P(2, 2));
  return {std::sqrt(P(0, 0)), std::sqrt(P(1, 1)), force_N / p.assumed_mass_kg, force_N, kNan, kNan};
}

// The subject of variant `variant` of `plan`.
Scenario vary(const Scenario& scenario, const EvaluationPlan& plan, std::size_t variant) {
  const double friction = plan.friction_factors[variant % plan.friction_factors.size()];
  const double mass = plan.mass_factors[variant / plan.friction_factors.size()];
  Scenario varied = scenario;
  varied.subject.friction_scale *= friction;
  varied.subject.jaw.mass_kg *= mass;
  varied.subject.jaw.inertia_kg_m2 *= mass;
  varied.subject.drive_mass_kg = scenario.subject.jaw.mass_kg;
  const double needed = needed_steps_per_millisecond(varied.subject);
  varied.subject.steps_per_millisecond =
      std::max(varied.subject.steps_per_millisecond, static_cast<int>(std::min(needed, 1e3)));
  return varied;
}

void add_identified(const IdentifiedValue<double>& value, double truth,
                    IdentifiedStatistics& statistics) {
  ++statistics.limits[static_cast<std::size_t>(value.limit)];
  const double error = value.fitted - truth;
  if (!std::isfinite(error) || !std::isfinite(value.fitted_sd)) return;
  statistics.error.add(error);
  statistics.square.add(error * error);
  statistics.fitted_sd.add(value.fitted_sd);
  if (value.limit != ImpedanceLimit::none) return;
  ++statistics.shown;
  if (std::abs(error) < kNormalQuantile95 * value.fitted_sd) ++statistics.covered;
}

void add_identified(const IdentifiedRun& run, Evaluation& evaluation) {
  const ImpedanceEstimate<double>& last = run.last;
  ++evaluation.identified;
  add_identified(last.friction_Ns_m, run.friction_Ns_m, evaluation.identified_friction);
  add_identified(last.mass_kg, run.mass_kg, evaluation.identified_mass);
}

}  // namespace

void add_run(const EvaluationRun& run, Evaluation& evaluation) {
  if (run.identified) add_identified(*run.identified, evaluation);
  for (std::size_t i = 0; i < kEvaluatedQuantities; ++i) {
    evaluation.errors[i].add_run(run.errors[i]);
    evaluation.not_computed[i] += run.not_computed[i];
  }
  evaluation.velocity_m_s.merge(run.velocity_m_s);
  evaluation.innovation_axes = std::max(evaluation.innovation_axes, run.innovation_axes);
  for (std::size_t axis = 0; axis < run.innovations.size(); ++axis) {
    const RunInnovations& innovations = run.innovations[axis];
    evaluation.innovations[axis].nis.add_run(innovations.nis);
    if (std::isfinite(innovations.correlation)) {
      evaluation.innovations[axis].correlation.add(innovations.correlation);
    }
  }
  evaluation.nees.add_run(run.nees);
  evaluation.samples += run.samples;
  evaluation.events.add(run.events);
  evaluation.friction_slope.add(run.friction.truth, run.friction.estimate);
  evaluation.mass_slope.add(run.mass.truth, run.mass.estimate);
  evaluation.friction.push_back(run.friction);
  evaluation.mass.push_back(run.mass);
  if (run.verdict) ++evaluation.verdicts[static_cast<std::size_t>(*run.verdict)];
}

Evaluation empty_evaluation(const EstimatorSettings& settings) {
  Evaluation evaluation;
  if (const auto* published = std::get_if<PublishedParameters>(&settings)) {
    evaluation.bound = bound_of_stage_1(*published);
  } else {
    evaluation.bound.fill(kNan);
  }
  return evaluation;
}

void refuse_nothing_compared(const std::string& scenario, const Evaluation& evaluation) {
  if (evaluation.is_computed(kPositionError)) return;
  throw InputError(scenario, "no sample of any run could be compared with the truth",
                   "raise duration_s or rate_Hz, or lose fewer samples");
}

void evaluate_shard(const Scenario& scenario, const EstimatorSettings& settings,
                    const EvaluationPlan& plan, const EvaluationShard& shard,
                    const std::function<void(const EvaluationRun&)>& take,
                    const EvaluationProgress& progress, MonteCarloControl control) {
  const std::uint64_t variants = plan.friction_factors.size() * plan.mass_factors.size();
  const std::uint64_t first = shard.begin(plan.runs), runs = shard.end(plan.runs) - first;
  std::atomic<std::uint64_t> instants = 0;  // simulated, in all runs
  const auto should_stop = [&] {
    ++instants;
    return control.stop && control.stop();
  };
  const auto show_progress = [&] {
    const double all = static_cast<double>(runs) * scenario.duration_s * scenario.facebow.rate_Hz;
    if (progress) progress(std::min(1.0, static_cast<double>(instants) / all));
  };
  control.while_waiting = show_progress;
  run_monte_carlo(
      runs, first,
      [&](std::uint64_t index) {
        return evaluate_run(vary(scenario, plan, static_cast<std::size_t>(index % variants)),
                            plan.first_seed + index / variants, settings, should_stop);
      },
      take, [&](std::uint64_t, std::uint64_t) { show_progress(); }, control);
}

Evaluation evaluate_estimator(const Scenario& scenario, const EstimatorSettings& settings,
                              const EvaluationPlan& plan, const EvaluationProgress& progress,
                              MonteCarloControl control) {
  Evaluation evaluation = empty_evaluation(settings);
  evaluate_shard(
      scenario, settings, plan, {}, [&](const EvaluationRun& run) { add_run(run, evaluation); },
      progress, control);
  if (!control.stop || !control.stop()) refuse_nothing_compared(scenario.name, evaluation);
  return evaluation;
}

}  // namespace condyle::host
