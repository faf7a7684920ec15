// SPDX-License-Identifier: Apache-2.0
// The estimator of the whole pose as a virtual sensor: fed with a facebow's samples.
#pragma once

#include <optional>

#include "condyle/estimator/motion/freeze_guard.h"
#include "condyle/estimator/pose/pose_estimator.h"
#include "condyle/estimator/pose/pose_follower.h"

namespace condyle {

/// What a PoseSensor cannot learn from samples.
struct PoseSettings {
  /// Orientation from which turns count; the first usable sample's unless given.
  std::optional<Eigen::Matrix3d> reference = {};
  /// For SampleKind::pose: the point in the pose's own frame that the instrument measures best (m).
  Eigen::Vector3d body_centre_m = Eigen::Vector3d::Zero();
};

/// The pose of the jaw from samples of three_points or pose. The body of three points is learned
/// from the first samples; its centre is their mean.
template <class Scalar, int kMostLag = 16>
class PoseSensor {
 public:
  using Estimator = PoseEstimator<Scalar, kMostLag>;
  using Estimate = typename Estimator::Estimate;

  /// Parameters and lag as for RecommendedEstimator.
  explicit PoseSensor(const MotionEstimatorParameters& parameters, int lag = 0,
                      const PoseSettings& settings = {});

  /// The estimate that is ready after `sample`, which is that of `lag` samples ago. A sample
  /// without a time, or whose time runs backwards, is passed on without values; so is a mere repeat
  /// of the last. Without a usable pose the estimator predicts.
  Estimate process(const Sample& sample, EventSet sample_events);

  /// After the last sample: the estimates that still wait (PoseEstimator::drain).
  [[nodiscard]] bool drain(Estimate& estimate) { return estimator_.drain(estimate); }

  const Estimator& estimator() const { return estimator_; }
  /// The body of the three points, in the jaw frame; none until its shape is settled.
  const std::optional<RigidBody<double>>& body() const { return follower_.body(); }

 private:
  using Measurement = typename Estimator::Measurement;

  // Finds the pose in `sample`, or adds the event that explains why there is none.
  void locate(const Sample& sample, Measurement& measurement) {
    if (!sample.position_valid || measurement.events.has(Event::zero_filled)) return;
    const bool was_settled = follower_.body().has_value();
    const PoseFit<double> fit = follower_.follow(sample);
    if (!was_settled && follower_.body()) {
      estimator_.set_body_centre(
          Eigen::Vector3d(follower_.body()->shape_m().rowwise().mean()).template cast<Scalar>());
    }
    measurement.is_measured = fit.status == PoseStatus::ok;
    measurement.pose = {fit.pose.rotation.template cast<Scalar>(),
                        fit.pose.translation.template cast<Scalar>()};
    measurement.events.add(Event::points_not_rigid, fit.status == PoseStatus::degenerate ||
                                                        fit.status == PoseStatus::not_rigid ||
                                                        fit.status == PoseStatus::not_a_rotation);
    measurement.events.add(Event::position_missing, fit.status == PoseStatus::unavailable ||
                                                        fit.status == PoseStatus::missing);
  }

  bool is_last(const Measurement& measurement) const {
    return measurement.is_measured && last_.is_measured &&
           measurement.pose.rotation == last_.pose.rotation &&
           measurement.pose.translation == last_.pose.translation;
  }

  PoseFollower<double> follower_;
  FreezeGuard guard_;
  Measurement last_;  // before the check for a freeze
  Estimator estimator_;
};

template <class Scalar, int kMostLag>
PoseSensor<Scalar, kMostLag>::PoseSensor(const MotionEstimatorParameters& parameters, int lag,
                                         const PoseSettings& settings)
    : estimator_(parameters, lag) {
  if (settings.reference) estimator_.set_reference(settings.reference->template cast<Scalar>());
  estimator_.set_body_centre(settings.body_centre_m.template cast<Scalar>());
}

template <class Scalar, int kMostLag>
auto PoseSensor<Scalar, kMostLag>::process(const Sample& sample, EventSet sample_events)
    -> Estimate {
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

#ifdef CONDYLE_SENSORS_COMPILED  // once, in a library
extern template class PoseSensor<double>;
extern template class PoseSensor<float>;
#endif

}  // namespace condyle
