// SPDX-License-Identifier: Apache-2.0
// The recommended estimator as a virtual sensor of the damping of chewing cycles, for a measured
// drive.
#pragma once

#include "condyle/estimator/changes/cycle_timeline.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "condyle/estimator/sensors/recommended_sensor.h"

namespace condyle {

/// A RecommendedEstimate, and the cycles that ended since the previous one.
template <class Scalar>
struct CycleEstimate : RecommendedEstimate<Scalar> {
  static constexpr std::size_t kMostCycles = 4;
  std::size_t cycle_count = 0;
  std::array<TimedCycle<Scalar>, kMostCycles> cycles{};
};

/// As DrivenSensor, without lag. Once the point has been identified, it watches the cycles of the
/// point instead of identifying it further.
template <class Scalar, int kAxes>
class CycleSensor {
 public:
  using Estimate = CycleEstimate<Scalar>;

  /// As RecommendedSensor; `axis` 0 to kAxes - 1 is the drive's.
  CycleSensor(const RecommendedParameters& parameters, const FollowedPoint& followed, int axis);

  /// As DrivenSensor.
  void add_drive(TimeNs time_ns, double drive_N);

  /// As DrivenSensor.
  Estimate process(const Sample& sample, EventSet sample_events);

  /// No estimate waits.
  [[nodiscard]] bool drain(Estimate&) { return false; }

  const CycleTimeline<Scalar>& timeline() const { return timeline_; }
  DriveCounts counts() const { return timeline_.counts(); }

 private:
  // To exceed this room, positions would have to wait for seconds.
  auto keep() {
    return [this](const TimedCycle<Scalar>& cycle) {
      if (ended_.cycle_count < Estimate::kMostCycles) ended_.cycles[ended_.cycle_count++] = cycle;
    };
  }

  int axis_;
  RecommendedSensor<Scalar, kAxes> motion_;
  CycleTimeline<Scalar> timeline_;
  Estimate ended_;
};

template <class Scalar, int kAxes>
CycleSensor<Scalar, kAxes>::CycleSensor(const RecommendedParameters& parameters,
                                        const FollowedPoint& followed, int axis)
    : axis_(axis),
      motion_(parameters, is_valid(parameters) ? 0 : kUnusableLag, followed),
      timeline_(parameters.impedance, parameters.changes) {}

template <class Scalar, int kAxes>
void CycleSensor<Scalar, kAxes>::add_drive(TimeNs time_ns, double drive_N) {
  timeline_.add_drive(time_ns, static_cast<Scalar>(drive_N), keep());
}

template <class Scalar, int kAxes>
auto CycleSensor<Scalar, kAxes>::process(const Sample& sample, EventSet sample_events) -> Estimate {
  if (sample.time_valid && sample.drive_valid) add_drive(sample.time_ns, sample.drive_N);
  static_cast<RecommendedEstimate<Scalar>&>(ended_) = motion_.process(sample, sample_events);
  if (ended_.is_ready && ended_.time_valid) {
    const AxisEstimate<Scalar>& axis = ended_.axes[axis_];
    const bool is_taken =
        std::isfinite(axis.innovation_m) && !ended_.events.has(Event::outlier_rejected);
    constexpr Scalar kMissing = std::numeric_limits<Scalar>::quiet_NaN();
    timeline_.add_position(ended_.time_ns, is_taken ? axis.measured_position_m : kMissing,
                           axis.noise_sd_m, keep());
  }
  const Estimate estimate = ended_;
  ended_.cycle_count = 0;
  return estimate;
}

#ifdef CONDYLE_SENSORS_COMPILED  // once, in a library
extern template class CycleSensor<double, 1>;
extern template class CycleSensor<double, 3>;
#endif

}  // namespace condyle
