// SPDX-License-Identifier: Apache-2.0
// Compiled with -fno-exceptions -fno-rtti: everything a target without an operating system uses.
#include "condyle/estimator/frozen_detector.h"
#include "condyle/estimator/observability.h"
#include "condyle/estimator/point_follower.h"
#include "condyle/estimator/published_sensor.h"
#include "condyle/estimator/recommended_estimator.h"
#include "condyle/firmware/run_loop.h"

template class condyle::PublishedCascade<float>;
template class condyle::PublishedCascade<double>;
template class condyle::RecommendedEstimator<float, 1>;
template class condyle::RecommendedEstimator<double, 1>;
template class condyle::RecommendedEstimator<float, 3>;
template class condyle::RecommendedEstimator<double, 3>;
template class condyle::RecommendedEstimator<float, 1, 0>;  // where memory is short

namespace condyle {
Observability<float> judge(const OperatingPoint<float>& point);
Observability<float> judge(const OperatingPoint<float>& point) {
  return judge_observability(observability_matrix<FullSystem>(point));
}
FollowedPosition follow(PointFollower& follower, FrozenDetector& detector, const Sample& sample);
FollowedPosition follow(PointFollower& follower, FrozenDetector& detector, const Sample& sample) {
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
