// SPDX-License-Identifier: Apache-2.0
#include "comparison/compared_estimator.h"

#include <utility>

#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/firmware/sensor_choice.h"
#include "estimation/replayed_drive.h"

namespace condyle::host {
namespace {

class ComparedPublished final : public ComparedEstimator {
 public:
  ComparedPublished(const PublishedParameters& parameters, FollowedCoordinate followed)
      : followed_(followed), sensor_(parameters, followed) {}
  std::optional<EstimateRow> process(const Sample& sample, EventSet events) override {
    return row_of(sample, followed_, sensor_.process(sample, events));
  }
  std::optional<EstimateRow> drain() override { return std::nullopt; }
  bool estimates_noise() const override { return false; }

 private:
  FollowedCoordinate followed_;
  PublishedSensor<double> sensor_;
};

// `Sensor`: with or without a drive.
template <class Sensor>
class ComparedRecommended final : public ComparedEstimator {
 public:
  template <class... Arguments>
  ComparedRecommended(Axis followed, bool adapts, Arguments&&... arguments)
      : followed_(followed), adapts_(adapts), sensor_(std::forward<Arguments>(arguments)...) {}
  std::optional<EstimateRow> process(const Sample& sample, EventSet events) override {
    const auto estimate = sensor_.process(sample, events);
    if (!estimate.is_ready) return std::nullopt;
    return row_of(estimate, followed_);
  }
  std::optional<EstimateRow> drain() override {
    typename Sensor::Estimate estimate;
    if (!sensor_.drain(estimate)) return std::nullopt;
    return row_of(estimate, followed_);
  }
  bool estimates_noise() const override { return adapts_; }
  std::optional<ImpedanceEstimate<double>> conclude() override {
    if constexpr (firmware::kIdentifying<Sensor>) {
      return sensor_.conclude();
    } else {
      return std::nullopt;
    }
  }
  std::vector<std::string> drive_notes() const override {
    if constexpr (firmware::kIdentifying<Sensor>) {
      return sensor_.notes();
    } else {
      return {};
    }
  }

 private:
  Axis followed_;
  bool adapts_;
  Sensor sensor_;
};

}  // namespace

RecommendedParameters compared_parameters(const EstimatorChoice& option,
                                          const DriveStatement& drive, const std::string& source,
                                          const RecordingInfo& info) {
  RecommendedParameters parameters = load_recommended_for(option, info, source);
  drive.apply(parameters.impedance);
  return parameters;
}

std::unique_ptr<ComparedEstimator> make_compared_estimator(
    const EstimatorChoice& option, const RecordingChoice& choice, const DriveStatement& drive,
    const std::string& source, const ReplayFacebow& facebow, const ComparedExtras& extras) {
  if (option.is_published()) {
    return std::make_unique<ComparedPublished>(
        load_published_for(option, facebow.median_step_ns(), source), choice.followed);
  }
  const RecordingInfo& info = facebow.info();
  const RecommendedParameters parameters = compared_parameters(option, drive, source, info);
  refuse_long_step(parameters, seconds(facebow.expected_step_ns()), source, "its median step",
                   kCheckTimes);
  const Axis axis = choice.followed.axis;
  const bool adapts = parameters.noise.adaptation == Adaptation::on;
  return firmware::with_hosted_sensor(
      {info.kind, info.has_drive || extras.drive != nullptr, parameters, option.lag,
       choice.point(extras.fits), axis},
      [&]<class Sensor>(std::type_identity<Sensor>,
                        const auto&... arguments) -> std::unique_ptr<ComparedEstimator> {
        if constexpr (firmware::kIdentifying<Sensor>) {
          return std::make_unique<ComparedRecommended<ReplayedDriveSensor<Sensor>>>(
              axis, adapts, extras.drive, parameters.impedance.drive.delay_s, arguments...);
        } else {
          return std::make_unique<ComparedRecommended<Sensor>>(axis, adapts, arguments...);
        }
      });
}

}  // namespace condyle::host
