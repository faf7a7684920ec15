// SPDX-License-Identifier: Apache-2.0
// The recommended estimator as a virtual sensor: fed with a facebow's samples.
#pragma once

#include "condyle/estimator/recommended_estimator.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// The recommended estimator at one point of the samples: along its only axis (`kAxes` 1, for
/// one_axis) or along x, y and z (3, for the others).
template <class Scalar, int kAxes, int kMostLag = 16>
class RecommendedSensor {
 public:
  using Estimator = RecommendedEstimator<Scalar, kAxes, kMostLag>;
  using Estimate = typename Estimator::Estimate;

  /// Parameters and lag as for RecommendedEstimator; `point` of three_points is followed.
  explicit RecommendedSensor(const RecommendedParameters& parameters, int lag = 0, int point = 1)
      : point_(point), estimator_(parameters, lag) {}

  /// The estimate that is ready after `sample`, which is that of `lag` samples ago. A sample
  /// without a time, or whose time runs backwards, is passed on without values; so is one that only
  /// repeats the last.
  Estimate process(const Sample& sample, EventSet sample_events) {
    typename Estimator::Measurement measurement;
    measurement.time_ns = sample.time_ns;
    measurement.events = sample_events;
    if (!sample.time_valid || sample_events.has(Event::time_reversed)) {
      return estimator_.skip(measurement, sample.time_valid);
    }
    if (sample_events.has(Event::time_restarted)) estimator_.restart_clock();
    measurement.is_measured = is_available(sample.kind, {point_, Axis::x}) &&
                              (kAxes == 3) == (sample.kind != SampleKind::one_axis);
    measurement.events.add(Event::position_missing, !measurement.is_measured);
    measurement.is_measured =
        measurement.is_measured && sample.position_valid && !sample_events.has(Event::zero_filled);
    if (measurement.is_measured) {
      for (int axis = 0; axis < kAxes; ++axis) {
        measurement.position_m[axis] =
            static_cast<Scalar>(followed_position_m(sample, {point_, static_cast<Axis>(axis)}));
      }
    }
    // One measurement told twice is one measurement.
    if (sample_events.has(Event::time_repeated) && is_last(measurement)) {
      return estimator_.skip(measurement, true);
    }
    last_ = measurement;
    return estimator_.step(measurement);
  }

  /// After the last sample: the estimates that still wait (RecommendedEstimator::drain).
  [[nodiscard]] bool drain(Estimate& estimate) { return estimator_.drain(estimate); }

  const Estimator& estimator() const { return estimator_; }

 private:
  bool is_last(const typename Estimator::Measurement& measurement) const {
    for (int axis = 0; axis < kAxes; ++axis) {
      if (measurement.position_m[axis] != last_.position_m[axis]) return false;
    }
    return measurement.is_measured && last_.is_measured;
  }

  int point_;
  typename Estimator::Measurement last_;
  Estimator estimator_;
};

}  // namespace condyle
