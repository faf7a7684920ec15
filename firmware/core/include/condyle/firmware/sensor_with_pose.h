// SPDX-License-Identifier: Apache-2.0
// The whole pose beside a followed point, in one pass. No heap, no exceptions.
#pragma once

#include <type_traits>
#include <utility>

#include "condyle/estimator/sensors/pose_sensor.h"

namespace condyle::firmware {

/// A `Sensor`, and a PoseSensor that is fed with the same samples.
template <class Sensor, int kMostLag = 16>
class SensorWithPose : public Sensor {
 public:
  using PoseSource = PoseSensor<double, kMostLag>;

  /// The Sensor's estimate, and the pose that is ready at the same sample.
  struct Estimate : Sensor::Estimate {
    PoseEstimate<double> pose;
  };

  /// `pose` should have the Sensor's parameters and lag. The other arguments construct the Sensor.
  template <class... Arguments>
  explicit SensorWithPose(const PoseSource& pose, Arguments&&... arguments)
      : Sensor(std::forward<Arguments>(arguments)...), pose_(pose) {}

  /// As the Sensor's.
  Estimate process(const Sample& sample, EventSet sample_events) {
    return {Sensor::process(sample, sample_events), pose_.process(sample, sample_events)};
  }

  /// As the Sensor's. Both have the same lag, so they end together.
  [[nodiscard]] bool drain(Estimate& estimate) {
    const bool has_point = Sensor::drain(estimate);
    const bool has_pose = pose_.drain(estimate.pose);
    if (!has_pose) estimate.pose = {};
    return has_point;
  }

  const PoseSource& pose() const { return pose_; }

 private:
  PoseSource pose_;
};

/// True of the estimates of a SensorWithPose.
template <class Estimate>
inline constexpr bool kHasPose = requires(const Estimate& estimate) {
  estimate.pose.centre_m;
};

}  // namespace condyle::firmware
