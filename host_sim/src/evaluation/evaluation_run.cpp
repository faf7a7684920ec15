// SPDX-License-Identifier: Apache-2.0
#include "evaluation/evaluation_run.h"

#include <cmath>
#include <deque>
#include <utility>

#include "condyle/estimator/math/innovation_monitor.h"
#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/firmware/sensor_choice.h"
#include "condyle/hal/clock.h"
#include "estimation/estimate_row.h"

namespace condyle::host {
namespace {

constexpr double kLeftOut = 0.2;

bool is_there(const Quantity<double>& quantity) {
  return quantity.provenance != Provenance::not_computed;
}

// In the order of EvaluatedIndex, as the truths below.
std::array<const Quantity<double>*, kEvaluatedQuantities> quantities_of(const EstimateRow& row) {
  return {&row.position_m, &row.velocity_m_s,  &row.followed.acceleration_m_s2,
          &row.force_N,    &row.friction_Ns_m, &row.mass_kg};
}

std::array<double, kEvaluatedQuantities> truths_of(const SubjectTruth& truth) {
  return {truth.position_m,
          truth.velocity_m_s,
          truth.acceleration_m_s2,
          truth.effective_mass_kg * truth.acceleration_m_s2,
          truth.effective_friction_Ns_m,
          truth.effective_mass_kg};
}

// The rows of one run against their truths.
class RunComparison {
 public:
  explicit RunComparison(double duration_s) : left_out_s_(kLeftOut * duration_s) {
    run_.velocity_m_s = ErrorOverTime(duration_s);
  }

  // `truth`: at the instant that `row` estimates.
  void add(const EstimateRow& row, const SubjectTruth& truth) {
    ++run_.samples;
    if (row.has_impedance) {
      if (!run_.identified) run_.identified.emplace();
      run_.identified->last = row.impedance;
    }
    run_.events.add(row.events);
    run_.velocity_m_s.add(truth.time_s, row.velocity_m_s.value - truth.velocity_m_s,
                          row.velocity_m_s.standard_deviation);
    if (is_there(row.friction_Ns_m)) run_.friction.estimate = row.friction_Ns_m.value;
    if (is_there(row.mass_kg)) {
      run_.mass.estimate = row.mass_kg.value;
      // A sample that was not used has no verdict.
      if (!row.has_impedance) run_.verdict = row.verdict;
    }
    if (truth.time_s < left_out_s_) return;
    const auto estimates = quantities_of(row);
    const auto truths = truths_of(truth);
    for (std::size_t i = 0; i < kEvaluatedQuantities; ++i) {
      if (is_there(*estimates[i])) {
        run_.errors[i].add(estimates[i]->value - truths[i], estimates[i]->standard_deviation);
      } else {
        ++run_.not_computed[i];
      }
    }
    if (!is_duplicate(row)) add_innovations(row);
    friction_.add(truth.effective_friction_Ns_m);
    mass_.add(truth.effective_mass_kg);
  }

  EvaluationRun result() && {
    run_.friction.truth = friction_.mean();
    run_.mass.truth = mass_.mean();
    if (run_.identified) {
      run_.identified->friction_Ns_m = run_.friction.truth;
      run_.identified->mass_kg = run_.mass.truth;
    }
    return std::move(run_);
  }

 private:
  void add_innovations(const EstimateRow& row) {
    run_.innovation_axes = innovation_axis_count(row);
    for (int axis = 0; axis < run_.innovation_axes; ++axis) {
      const double innovation = standardised_innovation(row, axis);
      const auto i = static_cast<std::size_t>(axis);
      monitors_[i].add(innovation, EstimateRow::kNone, EstimateRow::kNone);
      if (!std::isfinite(innovation)) continue;
      run_.innovations[i].nis.add(innovation * innovation);
      run_.innovations[i].correlation = monitors_[i].innovation_correlation();
    }
  }

  double left_out_s_;
  EvaluationRun run_;
  std::array<InnovationMonitor<double>, 3> monitors_;
  Moments friction_, mass_;  // true ones
};

// A simulated subject's facebow, and the truth of its samples. `add_drive(time_ns, force_N)`
// receives the drive before the corresponding samples.
template <class AddDrive>
class SimulatedFacebow final : public hal::Facebow {
 public:
  SimulatedFacebow(const Scenario& scenario, std::uint64_t seed, AddDrive add_drive)
      : simulation_(scenario, seed), add_drive_(add_drive) {}

  hal::Status open() override { return hal::Status::ok; }
  hal::Status read(TimeNs, Sample& sample) override {
    while (used_ == data_.samples.size()) {
      data_.clear();
      used_ = 0;
      if (!simulation_.advance(data_)) return hal::Status::end;
      for (const Reading& reading : data_.drive) add_drive_(reading.time_ns, reading.values[0]);
    }
    last_truth_ = data_.truths.back();
    truths_.push_back(last_truth_);
    sample = data_.samples[used_++];
    return hal::Status::ok;
  }
  void close() override {}

  // Of the first sample whose truth is still unused.
  SubjectTruth take_truth() {
    const SubjectTruth truth = truths_.front();
    truths_.pop_front();
    return truth;
  }
  // Of the last sample.
  const SubjectTruth& last_truth() const { return last_truth_; }

 private:
  Simulation simulation_;
  AddDrive add_drive_;
  SimulatedData data_;
  std::size_t used_ = 0;
  std::deque<SubjectTruth> truths_;
  SubjectTruth last_truth_;
};

// One run of `scenario` through `sensor`. `row_of_step(sample, estimate)` gives a row, or none
// while a lag fills. `last_truth` becomes that of the last sample.
template <class Sensor, class RowOfStep>
EvaluationRun run_through(const Scenario& scenario, std::uint64_t seed, double nominal_step_s,
                          const std::function<bool()>& should_stop, Sensor& sensor,
                          const RowOfStep& row_of_step, SubjectTruth& last_truth) {
  SimulatedFacebow facebow(scenario, seed,
                           [&]([[maybe_unused]] TimeNs time_ns, [[maybe_unused]] double drive_N) {
                             if constexpr (requires { sensor.add_drive(TimeNs{}, 0.0); })
                               sensor.add_drive(time_ns, drive_N);
                           });
  RunComparison comparison(scenario.duration_s);
  hal::ManualClock clock;
  firmware::RunSettings settings;
  settings.nominal_step_ns = nanoseconds(nominal_step_s);
  firmware::RunCounts counts;
  (void)firmware::run(
      facebow, clock, sensor, settings, counts,
      [&](const Sample& sample, const typename Sensor::Estimate& estimate) {
        const std::optional<EstimateRow> row = row_of_step(sample, estimate);
        if (row) comparison.add(*row, facebow.take_truth());
      },
      [&] { return should_stop && should_stop(); });
  last_truth = facebow.last_truth();
  return std::move(comparison).result();
}

EvaluationRun run_recommended(const Scenario& scenario, std::uint64_t seed,
                              const RecommendedSettings& settings,
                              const std::function<bool()>& should_stop) {
  SubjectTruth last_truth;
  const auto run = [&](auto sensor) {
    return run_through(
        scenario, seed, 1 / scenario.facebow.rate_Hz, should_stop, sensor,
        [&](const Sample&, const auto& estimate) -> std::optional<EstimateRow> {
          if (!estimate.is_ready) return std::nullopt;
          EstimateRow row = row_of(estimate, scenario.axis);
          for (Quantity<double>* quantity : {&row.friction_Ns_m, &row.mass_kg}) {
            if (quantity->provenance == Provenance::assumed) *quantity = {};
          }
          return row;
        },
        last_truth);
  };
  const SampleKind kind =
      scenario.facebow.gives_points ? SampleKind::three_points : SampleKind::one_axis;
  return firmware::with_hosted_sensor(
      {kind, scenario.drive.rate_Hz > 0, settings.parameters, settings.lag, {}, scenario.axis},
      [&]<class Sensor>(std::type_identity<Sensor>, const auto&... arguments) {
        return run(Sensor(arguments...));
      });
}

EvaluationRun run_published(const Scenario& scenario, std::uint64_t seed,
                            const PublishedParameters& parameters,
                            const std::function<bool()>& should_stop) {
  const FollowedCoordinate followed{1, scenario.axis};
  PublishedSensor<double> sensor(parameters, followed);
  SubjectTruth truth;
  EvaluationRun run = run_through(
      scenario, seed, parameters.sample_time_s, should_stop, sensor,
      [&](const Sample& sample, const PublishedEstimate<double>& estimate) {
        EstimateRow row = row_of(sample, followed, estimate);
        Quantity<double>& acceleration_m_s2 = row.followed.acceleration_m_s2;
        acceleration_m_s2 = row.force_N;
        acceleration_m_s2.value /= parameters.assumed_mass_kg;
        acceleration_m_s2.standard_deviation /= parameters.assumed_mass_kg;
        return std::optional(row);
      },
      truth);
  if (run.samples == 0) return run;
  const auto& filter = sensor.cascade().motion_filter();
  const Eigen::Vector3d error =
      filter.x - Eigen::Vector3d(truth.position_m, truth.velocity_m_s,
                                 parameters.assumed_mass_kg * truth.acceleration_m_s2);
  run.nees.add(normalised_square<3>(error, filter.P.dense()));
  return run;
}

}  // namespace

EvaluationRun evaluate_run(const Scenario& scenario, std::uint64_t seed,
                           const EstimatorSettings& settings,
                           const std::function<bool()>& should_stop) {
  if (const auto* published = std::get_if<PublishedParameters>(&settings)) {
    return run_published(scenario, seed, *published, should_stop);
  }
  return run_recommended(scenario, seed, std::get<RecommendedSettings>(settings), should_stop);
}

}  // namespace condyle::host
