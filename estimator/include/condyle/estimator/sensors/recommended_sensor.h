// SPDX-License-Identifier: Apache-2.0
// The recommended estimator as a virtual sensor: fed with a facebow's samples.
#pragma once

#include "condyle/estimator/motion/freeze_guard.h"
#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/pose/point_follower.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// The recommended estimator at one point of the samples: along its only axis (`kAxes` 1, for
/// one_axis) or along x, y and z (3, for the other kinds).
template <class Scalar, int kAxes, int kMostLag = 16>
class RecommendedSensor {
 public:
  using Estimator = RecommendedEstimator<Scalar, kAxes, kMostLag>;
  using Estimate = typename Estimator::Estimate;

  /// Parameters and lag as for RecommendedEstimator; `followed` is not used for one_axis.
  explicit RecommendedSensor(const MotionEstimatorParameters& parameters, int lag = 0,
                             const FollowedPoint& followed = {});

  /// The estimate that is ready after `sample`, which is that of `lag` samples ago. A sample
  /// without a time, or whose time runs backwards, is passed on without values; so is a mere repeat
  /// of the last. Without a usable position the estimator predicts.
  Estimate process(const Sample& sample, EventSet sample_events);

  /// After the last sample: the estimates that still wait (RecommendedEstimator::drain).
  [[nodiscard]] bool drain(Estimate& estimate);

  const Estimator& estimator() const { return estimator_; }
  /// RecommendedEstimator::keep_steps.
  void keep_steps() { estimator_.keep_steps(); }

 private:
  using Measurement = typename Estimator::Measurement;

  // Finds the followed position in `sample`, or adds the event that explains why there is none.
  void locate(const Sample& sample, Measurement& measurement) {
    if (!sample.position_valid || measurement.events.has(Event::zero_filled)) return;
    if constexpr (kAxes == 1) {
      measurement.is_measured = sample.kind == SampleKind::one_axis;
      measurement.position_m[0] = static_cast<Scalar>(sample.coordinates[0]);
    } else {
      const FollowedPosition found = follower_.follow(sample);
      measurement.is_measured = found.status == PoseStatus::ok;
      for (int axis = 0; axis < kAxes; ++axis) {
        measurement.position_m[axis] = static_cast<Scalar>(found.position_m[axis]);
      }
      if (measurement.is_measured && !has_noise_) set_noise(found.lever_m);
      measurement.events.add(Event::points_not_rigid,
                             found.status == PoseStatus::degenerate ||
                                 found.status == PoseStatus::not_rigid ||
                                 found.status == PoseStatus::not_a_rotation);
      measurement.events.add(Event::position_missing, found.status == PoseStatus::unavailable ||
                                                          found.status == PoseStatus::missing);
    }
    measurement.events.add(Event::position_missing,
                           kAxes == 1 && sample.kind != SampleKind::one_axis);
  }

  // Noise of the point for the jaw's pose at the first sample; the lever turns little with the jaw.
  void set_noise(const Eigen::Vector3d& lever_m) {
    const Eigen::Vector3d sd_m =
        point_noise_sd_m(noise_.position_sd_m, noise_.rotation_sd_rad, lever_m);
    Array<Scalar, kAxes> noise_sd_m;
    for (int axis = 0; axis < kAxes; ++axis) noise_sd_m[axis] = static_cast<Scalar>(sd_m[axis]);
    estimator_.set_noise(noise_sd_m);
    has_noise_ = true;
  }

  bool is_last(const Measurement& measurement) const {
    for (int axis = 0; axis < kAxes; ++axis) {
      if (measurement.position_m[axis] != last_.position_m[axis]) return false;
    }
    return measurement.is_measured && last_.is_measured;
  }

  NoiseParameters noise_;
  PointFollower<double> follower_;
  FreezeGuard guard_;
  bool has_noise_ = false;
  Measurement last_;  // before the check for a freeze
  Estimator estimator_;
};

/// A lag that no sensor supports: each estimate has the event `parameters_invalid`.
inline constexpr int kUnusableLag = -1;

template <class Scalar, int kAxes, int kMostLag>
RecommendedSensor<Scalar, kAxes, kMostLag>::RecommendedSensor(
    const MotionEstimatorParameters& parameters, int lag, const FollowedPoint& followed)
    : noise_(parameters.noise), follower_(followed), estimator_(parameters, lag) {}

template <class Scalar, int kAxes, int kMostLag>
auto RecommendedSensor<Scalar, kAxes, kMostLag>::process(const Sample& sample,
                                                         EventSet sample_events) -> Estimate {
  guard_.count();
  Measurement measurement;
  measurement.time_ns = sample.time_ns;
  measurement.events = sample_events;
  if (!sample.time_valid || sample_events.has(Event::time_reversed)) {
    return estimator_.skip(measurement, sample.time_valid);
  }
  if (sample_events.has(Event::time_restarted)) estimator_.restart_clock();
  locate(sample, measurement);
  if (sample_events.has(Event::time_repeated)) {
    // A repeated report of one measurement is one measurement.
    if (is_last(measurement)) return estimator_.skip(measurement, true);
  }
  last_ = measurement;
  if (!sample_events.has(Event::time_repeated)) guard_.judge(sample, measurement, estimator_);
  return estimator_.step(measurement);
}

template <class Scalar, int kAxes, int kMostLag>
bool RecommendedSensor<Scalar, kAxes, kMostLag>::drain(Estimate& estimate) {
  return estimator_.drain(estimate);
}

#ifdef CONDYLE_SENSORS_COMPILED  // once, in a library
extern template class RecommendedSensor<double, 1>;
extern template class RecommendedSensor<double, 3>;
extern template class RecommendedSensor<float, 1>;
extern template class RecommendedSensor<float, 3>;
#endif

}  // namespace condyle
