// SPDX-License-Identifier: Apache-2.0
// Compiled with -fno-exceptions -fno-rtti: everything a target without an operating system uses. In
// float alone: what throws does not depend on the scalar.
#include "condyle/estimator/changes/change_detector.h"
#include "condyle/estimator/changes/cycle_damping.h"
#include "condyle/estimator/emg/emg_envelope.h"
#include "condyle/estimator/emg/emg_timeline.h"
#include "condyle/estimator/impedance/head_motion.h"
#include "condyle/estimator/motion/frozen_detector.h"
#include "condyle/estimator/motion/motion_cycles.h"
#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/pose/point_follower.h"
#include "condyle/estimator/release/release_pair.h"
#include "condyle/estimator/sensors/driven_sensor.h"
#include "condyle/estimator/sensors/pose_sensor.h"
#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/firmware/run_loop.h"
#include "observability/observability.h"

template class condyle::ChangeDetector<float>;
template class condyle::CycleDamping<float>;
template class condyle::HeadMotionIdentification<float>;
template class condyle::DrivenSensor<float, 3>;
template class condyle::EmgEnvelope<float>;
template class condyle::EmgIdentification<float>;
template class condyle::EmgTimeline<float>;
template class condyle::PointFollower<float>;
template class condyle::PointIdentification<float>;
template class condyle::PoseEstimator<float>;
template class condyle::PoseSensor<float, 0>;  // where memory is short
template class condyle::PublishedCascade<float>;
template class condyle::RecommendedEstimator<float, 1>;
template class condyle::RecommendedEstimator<float, 3>;
template class condyle::RecommendedEstimator<float, 1, 0>;  // where memory is short

template condyle::PassiveRelease<float> condyle::fit_passive_release(std::span<const float>,
                                                                     std::span<const float>,
                                                                     const ReleaseSettings&);
template condyle::ReleasePair<float> condyle::combine_releases(const PassiveRelease<float>&,
                                                               const PassiveRelease<float>&,
                                                               const ReleasePairSettings&);

template class condyle::MotionCycles<float>;

namespace condyle {
Observability<float> judge(const OperatingPoint<float>& point);
Observability<float> judge(const OperatingPoint<float>& point) {
  return judge_observability(observability_matrix<FullSystem>(point));
}
TurnEstimate<float> turn_and_point(const PoseEstimate<float>& pose, PointEstimate<float>& point);
TurnEstimate<float> turn_and_point(const PoseEstimate<float>& pose, PointEstimate<float>& point) {
  point = pose.point({0, 0, 0.1F});
  return pose.turn_about({1, 0, 0});
}
FollowedPosition follow(PointFollower<float>& follower, FrozenDetector& detector,
                        const Sample& sample);
FollowedPosition follow(PointFollower<float>& follower, FrozenDetector& detector,
                        const Sample& sample) {
  if (detector.add(sample)) return {.status = PoseStatus::missing};
  return follower.follow(sample);
}
void run_through(hal::Facebow& facebow, hal::Clock& clock, PublishedSensor<float>& sensor);
void run_through(hal::Facebow& facebow, hal::Clock& clock, PublishedSensor<float>& sensor) {
  firmware::RunCounts counts;
  static_cast<void>(firmware::run(
      facebow, clock, sensor, {}, counts, [](const Sample&, const PublishedEstimate<float>&) {},
      [] { return false; }));
}
}  // namespace condyle
