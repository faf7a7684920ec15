// SPDX-License-Identifier: Apache-2.0
#include "estimator_run.h"

#include <optional>
#include <type_traits>

#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/firmware/sensor_choice.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr const char* kName = "samples";

class PublishedRun final : public EstimatorRun {
 public:
  PublishedRun(const PublishedParameters& parameters, const RunChoice& choice)
      : followed_(choice.followed),
        checker_(nanoseconds(parameters.sample_time_s), choice.has_drive, choice.followed),
        sensor_(parameters, choice.followed) {}

  const EstimateRow* process(const Sample& sample) override {
    row_ = row_of(sample, followed_, sensor_.process(sample, checker_.check(sample)));
    return &row_;
  }
  const EstimateRow* drain() override { return nullptr; }

 private:
  FollowedCoordinate followed_;
  SampleChecker checker_;
  PublishedSensor<double> sensor_;
  EstimateRow row_;
};

template <class Sensor>
class RecommendedRun final : public EstimatorRun {
 public:
  template <class... Arguments>
  explicit RecommendedRun(const RunChoice& choice, const Arguments&... arguments)
      : axis_(choice.followed.axis),
        checker_(nanoseconds(choice.step_s), choice.has_drive, choice.followed),
        sensor_(arguments...) {}

  const EstimateRow* process(const Sample& sample) override {
    const auto estimate = sensor_.process(sample, checker_.check(sample));
    if (!estimate.is_ready) return nullptr;
    row_ = row_of(estimate, axis_);
    return &row_;
  }
  const EstimateRow* drain() override {
    typename Sensor::Estimate waiting;
    if (!sensor_.drain(waiting) || !waiting.is_ready) return nullptr;
    row_ = row_of(waiting, axis_);
    return &row_;
  }
  bool learns() const override { return sensor_.learns(); }
  const ImpedanceEstimate<double>* conclude() override {
    if constexpr (firmware::kIdentifying<Sensor>) {
      return &sensor_.conclude();
    } else {
      return nullptr;
    }
  }

 private:
  Axis axis_;
  SampleChecker checker_;
  Sensor sensor_;
  EstimateRow row_;
};

}  // namespace

std::unique_ptr<EstimatorRun> make_estimator_run(const RunChoice& choice) {
  const EstimatorChoice& estimator = choice.estimator;
  choice.check(kName, choice.kind);
  estimator.refuse_if_published("--lag", estimator.lag > 0);
  estimator.refuse_if_published("--jaw-point-mm", !choice.jaw_point_mm.empty());
  estimator.refuse_if_published("options of the drive", choice.drive.is_given());
  if (choice.drive.is_given() && !choice.has_drive) {
    throw InputError(kName, "have no drive, so options of the drive do not apply",
                     "give a drive, or leave them out");
  }
  if (estimator.is_published()) {
    const std::optional<TimeNs> step_ns =
        choice.step_s > 0 ? std::optional(nanoseconds(choice.step_s)) : std::nullopt;
    return std::make_unique<PublishedRun>(load_published_for(estimator, step_ns, kName), choice);
  }
  RecommendedParameters parameters = estimator.load_recommended();
  refuse_long_step(parameters, choice.step_s, kName, "their median step",
                   "check the unit of the times");
  choice.drive.apply(parameters.impedance);
  return firmware::with_hosted_sensor(
      {choice.kind, choice.has_drive, parameters, estimator.lag, choice.point(),
       choice.followed.axis},
      [&]<class Sensor>(std::type_identity<Sensor>,
                        const auto&... arguments) -> std::unique_ptr<EstimatorRun> {
        return std::make_unique<RecommendedRun<Sensor>>(choice, arguments...);
      });
}

}  // namespace condyle::host
