// SPDX-License-Identifier: Apache-2.0
// The recommended estimator as a virtual sensor that also identifies friction and mass, for a
// measured drive.
#pragma once

#include "condyle/estimator/impedance/point_identification.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "condyle/estimator/sensors/recommended_sensor.h"

namespace condyle {

/// A RecommendedEstimate, and the results for the followed point at that time.
template <class Scalar>
struct DrivenEstimate : RecommendedEstimate<Scalar> {
  ImpedanceEstimate<Scalar> impedance;
};

/// As RecommendedSensor; the identification follows one of its axes. It uses the positions that the
/// recommended estimator used.
template <class Scalar, int kAxes, int kMostLag = 16>
class DrivenSensor {
 public:
  using Estimate = DrivenEstimate<Scalar>;
  using Estimator = RecommendedEstimator<Scalar, kAxes, kMostLag>;

  /// As RecommendedSensor; `axis` 0 to kAxes - 1 is the drive's.
  DrivenSensor(const DrivenParameters& parameters, int lag, const FollowedPoint& followed,
               int axis);

  /// A drive (N) measured apart from the samples, stamped on their clock; no later than the first
  /// sample after it.
  void add_drive(TimeNs time_ns, double drive_N);

  /// As RecommendedSensor; uses the drive in `sample`, if there is one.
  Estimate process(const Sample& sample, EventSet sample_events);

  /// As RecommendedSensor.
  [[nodiscard]] bool drain(Estimate& estimate);

  /// Concludes from everything given so far, as at the end of a recording.
  const ImpedanceEstimate<Scalar>& conclude() {
    identification_.conclude();
    return identification_.estimate();
  }

  /// The last conclusion, and the number of conclusions.
  const ImpedanceEstimate<Scalar>& conclusion() const { return identification_.estimate(); }
  std::uint64_t conclusions() const { return identification_.conclusions(); }
  DriveCounts counts() const { return identification_.counts(); }
  const Estimator& estimator() const { return motion_.estimator(); }
  /// RecommendedEstimator::keep_steps.
  void keep_steps() { motion_.keep_steps(); }

 private:
  Estimate complete(Estimate estimate);

  int axis_;
  RecommendedSensor<Scalar, kAxes, kMostLag> motion_;
  PointIdentification<Scalar> identification_;
};

template <class Scalar, int kAxes, int kMostLag>
DrivenSensor<Scalar, kAxes, kMostLag>::DrivenSensor(const DrivenParameters& parameters, int lag,
                                                    const FollowedPoint& followed, int axis)
    : axis_(axis),
      motion_(parameters, is_valid(parameters) ? lag : kUnusableLag, followed),
      identification_(parameters.impedance) {}

template <class Scalar, int kAxes, int kMostLag>
void DrivenSensor<Scalar, kAxes, kMostLag>::add_drive(TimeNs time_ns, double drive_N) {
  identification_.add_drive(time_ns, static_cast<Scalar>(drive_N));
}

template <class Scalar, int kAxes, int kMostLag>
auto DrivenSensor<Scalar, kAxes, kMostLag>::process(const Sample& sample, EventSet sample_events)
    -> Estimate {
  if (sample.time_valid && sample.drive_valid) add_drive(sample.time_ns, sample.drive_N);
  return complete({motion_.process(sample, sample_events), {}});
}

template <class Scalar, int kAxes, int kMostLag>
bool DrivenSensor<Scalar, kAxes, kMostLag>::drain(Estimate& estimate) {
  if (!motion_.drain(estimate)) return false;
  estimate = complete(estimate);
  return true;
}

template <class Scalar, int kAxes, int kMostLag>
auto DrivenSensor<Scalar, kAxes, kMostLag>::complete(Estimate estimate) -> Estimate {
  const AxisEstimate<Scalar>& axis = estimate.axes[axis_];
  const bool is_taken = estimate.is_ready && estimate.time_valid &&
                        std::isfinite(axis.innovation_m) &&
                        !estimate.events.has(Event::outlier_rejected);
  if (is_taken) identification_.add_position(estimate.time_ns, axis.measured_position_m);
  estimate.impedance = identification_.estimate();
  return estimate;
}

#ifdef CONDYLE_SENSORS_COMPILED  // once, in a library
extern template class DrivenSensor<double, 1>;
extern template class DrivenSensor<double, 3>;
extern template class DrivenSensor<float, 1>;
extern template class DrivenSensor<float, 3>;
#endif

}  // namespace condyle
