// SPDX-License-Identifier: Apache-2.0
// The published cascade as a virtual sensor: fed with a facebow's samples.
#pragma once

#include <optional>

#include "condyle/estimator/published/published_cascade.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// The position of `sample` (m) that the cascade takes as a measurement; absent if the sample has
/// no usable one.
inline std::optional<double> published_measurement_m(const Sample& sample, EventSet sample_events,
                                                     FollowedCoordinate followed) {
  const bool usable = sample.position_valid && !sample_events.has(Event::zero_filled) &&
                      is_available(sample.kind, followed);
  return usable ? std::optional(followed_position_m(sample, followed)) : std::nullopt;
}

/// The published cascade along one coordinate of the samples.
template <class Scalar>
class PublishedSensor {
 public:
  using Estimate = PublishedEstimate<Scalar>;

  /// Parameters as for PublishedCascade.
  explicit PublishedSensor(const PublishedParameters& parameters, FollowedCoordinate followed = {})
      : followed_(followed), cascade_(parameters) {}

  /// The estimate of one sample, with the sample's events added. A sample whose time runs backwards
  /// is not passed to the cascade; one without a usable position only lets it predict.
  Estimate process(const Sample& sample, EventSet sample_events);

  /// No estimate waits for later samples.
  [[nodiscard]] bool drain(Estimate&) { return false; }

  const PublishedCascade<Scalar>& cascade() const { return cascade_; }

 private:
  FollowedCoordinate followed_;
  PublishedCascade<Scalar> cascade_;
};

template <class Scalar>
auto PublishedSensor<Scalar>::process(const Sample& sample, EventSet sample_events) -> Estimate {
  Estimate estimate;
  if (!sample_events.has(Event::time_reversed)) {
    const auto position_m = published_measurement_m(sample, sample_events, followed_);
    estimate = position_m ? cascade_.step(static_cast<Scalar>(*position_m))
                          : cascade_.step_without_measurement();
    estimate.events.add(Event::position_missing, !is_available(sample.kind, followed_));
  }
  estimate.events.add(sample_events);
  return estimate;
}

#ifdef CONDYLE_SENSORS_COMPILED  // once, in a library
extern template class PublishedSensor<double>;
extern template class PublishedSensor<float>;
#endif

}  // namespace condyle
