// SPDX-License-Identifier: Apache-2.0
#include "evaluation/cascade_evaluation.h"

#include <algorithm>
#include <cmath>

#include "condyle/estimator/published_sensor.h"
#include "evaluation/cramer_rao.h"
#include "input_error.h"

namespace condyle::host {
namespace {

constexpr double kLeftOut = 0.2;

// The bound after so many samples that it no longer changes.
std::array<double, 3> bound_of_stage_1(const PublishedParameters& p) {
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
  return {std::sqrt(P(0, 0)), std::sqrt(P(1, 1)), std::sqrt(P(2, 2))};
}

}  // namespace

EvaluationRun evaluate_run(const Scenario& scenario, std::uint64_t seed,
                           const PublishedParameters& parameters,
                           const std::function<bool()>& stop) {
  Simulation simulation(scenario, seed);
  PublishedSensor<double> sensor(parameters, {1, scenario.axis});
  SampleChecker checker(nanoseconds(parameters.sample_time_s));
  EvaluationRun run;
  SimulatedData data;
  double friction_sum = 0, mass_sum = 0;
  std::uint64_t compared = 0;
  SubjectTruth truth;
  while (simulation.advance(data)) {
    if (stop && stop()) break;
    truth = data.truths.back();
    for (const Sample& sample : data.samples) {
      const auto estimate = sensor.process(sample, checker.check(sample));
      run.verdict = estimate.verdict;
      run.friction.estimate = estimate.friction_Ns_m.value;
      run.mass.estimate = estimate.mass_kg.value;
      if (truth.time_s < kLeftOut * scenario.duration_s) continue;
      const double net_force_N = truth.effective_mass_kg * truth.acceleration_m_s2;
      const auto compare = [&](std::size_t i, const Quantity<double>& quantity, double true_value) {
        run.errors[i].add(quantity.value - true_value, quantity.standard_deviation);
      };
      compare(0, estimate.position_m, truth.position_m);
      compare(1, estimate.velocity_m_s, truth.velocity_m_s);
      compare(2, estimate.force_N, net_force_N);
      compare(3, estimate.friction_Ns_m, truth.effective_friction_Ns_m);
      compare(4, estimate.mass_kg, truth.effective_mass_kg);
      if (std::isfinite(estimate.motion_nis)) run.nis.add(estimate.motion_nis);
      friction_sum += truth.effective_friction_Ns_m;
      mass_sum += truth.effective_mass_kg;
      ++compared;
    }
    data.clear();
  }
  if (compared == 0) return run;
  run.friction.truth = friction_sum / static_cast<double>(compared);
  run.mass.truth = mass_sum / static_cast<double>(compared);
  const auto& filter = sensor.cascade().motion_filter();
  const Eigen::Vector3d error =
      filter.x - Eigen::Vector3d(truth.position_m, truth.velocity_m_s,
                                 parameters.assumed_mass_kg * truth.acceleration_m_s2);
  run.nees.add(normalised_square<3>(error, filter.P.dense()));
  return run;
}

Evaluation evaluate_cascade(const Scenario& scenario, const PublishedParameters& parameters,
                            const EvaluationPlan& plan, const MonteCarloProgress& progress,
                            const MonteCarloControl& control) {
  Evaluation evaluation;
  evaluation.bound = bound_of_stage_1(parameters);
  const std::uint64_t variants = plan.friction_factors.size() * plan.mass_factors.size();
  const auto work = [&](std::uint64_t index) {
    const std::uint64_t variant = index % variants;
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
    return evaluate_run(varied, plan.first_seed + index / variants, parameters, control.stop);
  };
  run_monte_carlo(
      plan.runs, 0, work,
      [&](EvaluationRun&& run) {
        for (std::size_t i = 0; i < kEvaluatedQuantities; ++i) {
          evaluation.errors[i].add_run(run.errors[i]);
        }
        evaluation.nis.add_run(run.nis);
        evaluation.nees.add_run(run.nees);
        evaluation.friction_slope.add(run.friction.truth, run.friction.estimate);
        evaluation.mass_slope.add(run.mass.truth, run.mass.estimate);
        evaluation.friction.push_back(run.friction);
        evaluation.mass.push_back(run.mass);
        ++evaluation.verdicts[static_cast<std::size_t>(run.verdict)];
      },
      progress, control);
  const bool stopped = control.stop && control.stop();
  if (!stopped && evaluation.errors[0].report(0.99).samples == 0) {
    throw InputError(scenario.name, "no sample of any run could be compared with the truth",
                     "raise duration_s or rate_Hz, or lose fewer samples");
  }
  return evaluation;
}

}  // namespace condyle::host
