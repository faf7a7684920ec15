// SPDX-License-Identifier: Apache-2.0
// A sensor of the recommended estimator whose velocity, acceleration and force are corrected by
// what it learns from the recording itself (motion_corrector.h), each axis by itself.
//
// The teacher is the estimator's own motion kTeacher_s later, 2 to kMostLag samples. Estimates with
// a lag below the teacher's are corrected too; innovations then say nothing about the correction,
// because the estimates have used them. A correction that is not made, for whichever reason, leaves
// value and interval of the estimator.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "condyle/estimator/motion/motion_corrector.h"
#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/sensors/driven_sensor.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "condyle/estimator/sensors/recommended_sensor.h"

namespace condyle {

/// What was learned along one axis.
struct LearningCounts {
  std::uint64_t samples = 0;           ///< with a velocity
  std::uint64_t corrected = 0;         ///< of those, with a correction of the velocity
  std::uint64_t compared = 0;          ///< corrected ones whose next sample was measured; lag 0
  double filter_square_m2 = 0;         ///< sum of squares of the filter's errors of that sample,
  double corrected_square_m2 = 0;      ///< and of the corrected motion's
  std::uint64_t silent_for_noise = 0;  ///< samples at which the noise was not white

  /// Root mean square of the corrected motion's errors of the next sample, divided by the filter's;
  /// NaN if there are none.
  double error_ratio() const { return std::sqrt(corrected_square_m2 / filter_square_m2); }
};

/// `Sensor`: a RecommendedSensor or DrivenSensor for `kAxes` axes, of at least 2 samples of memory.
/// `kKernels`: kernels for which there is memory.
template <class Sensor, class Scalar, int kAxes, int kMostLag, int kKernels>
class LearnedSensor : public Sensor {
 public:
  using Estimate = typename Sensor::Estimate;

  /// As the Sensor's. `parameters.learning.kernels` of more than kKernels counts as kKernels; of 0
  /// leaves the Sensor's estimates as they are.
  template <class Parameters, class... Arguments>
  explicit LearnedSensor(const Parameters& parameters, Arguments&&... arguments)
      : Sensor(parameters, std::forward<Arguments>(arguments)...),
        assumed_mass_kg_(static_cast<Scalar>(parameters.assumed_mass_kg)),
        learns_(is_valid(parameters) && kernels_of(parameters) > 0 &&
                this->estimator().lag() >= 0 && this->estimator().lag() < kMostLag) {
    if (learns_) this->keep_steps();
    for (Corrector& corrector : correctors_) corrector.limit_kernels(kernels_of(parameters));
  }

  /// As the Sensor's.
  Estimate process(const Sample& sample, EventSet sample_events);

  /// True if the sensor may correct its values: the parameters state kernels, and the lag is below
  /// kMostLag.
  bool learns() const { return learns_; }
  /// What was learned along `axis`, 0 to kAxes - 1.
  const LearningCounts& learning(int axis) const { return counts_[axis]; }
  /// The corrector of `axis`, to keep what it has learned, or before the first sample to begin with
  /// what was kept.
  MotionCorrector<Scalar, kKernels, kMostLag>& corrector(int axis) { return correctors_[axis]; }
  /// Mean step of the samples (s); 0 before the first two.
  Scalar mean_step_s() const { return mean_step_s_; }

 private:
  using Corrector = MotionCorrector<Scalar, kKernels, kMostLag>;
  static constexpr double kTeacher_s = 0.05;
  static constexpr int kFirstSteps = 16;
  static constexpr Scalar kStepMemory = 100;

  // A correction, until the next sample shows whether it was right.
  struct Expectation {
    TimeNs time_ns = 0;
    Array<Scalar, 2> correction = {};
    bool is_open = false;
  };

  template <class Parameters>
  static int kernels_of(const Parameters& parameters) {
    const double kernels = parameters.learning.kernels;
    return kernels >= 1 ? std::min(static_cast<int>(std::min(kernels, 1e6)), kKernels) : 0;
  }

  void correct(Estimate& estimate);
  void correct(int axis, Estimate& estimate, const TaughtMotion<Scalar>* taught);
  // Would the last sample's corrections have predicted this one better? Outliers count for neither.
  void compare(int axis, const AxisEstimate<Scalar>& values, const Estimate& estimate);
  // The teacher's lag for the mean step of the samples.
  void find_lag(TimeNs time_ns);
  void lose_motion();

  Scalar assumed_mass_kg_;
  Array<Corrector, kAxes> correctors_;
  bool learns_;
  Array<LearningCounts, kAxes> counts_ = {};
  Array<Expectation, kAxes> expectations_ = {};
  bool has_time_ = false;
  TimeNs time_ns_ = 0;
  Scalar steps_ = 0, mean_step_s_ = 0;
  int lag_ = 0;  // of the teacher; 0: not known yet
};

template <class Sensor, class Scalar, int kAxes, int kMostLag, int kKernels>
auto LearnedSensor<Sensor, Scalar, kAxes, kMostLag, kKernels>::process(const Sample& sample,
                                                                       EventSet sample_events)
    -> Estimate {
  Estimate estimate = Sensor::process(sample, sample_events);
  if (learns_) correct(estimate);
  return estimate;
}

template <class Sensor, class Scalar, int kAxes, int kMostLag, int kKernels>
void LearnedSensor<Sensor, Scalar, kAxes, kMostLag, kKernels>::correct(Estimate& estimate) {
  const EventSet events = estimate.events;
  if (events.has(Event::state_lost) || events.has(Event::state_restarted) ||
      events.has(Event::position_frozen) || events.has(Event::time_restarted)) {
    lose_motion();
  }
  const bool has_motion = estimate.is_ready && estimate.time_valid &&
                          std::isfinite(estimate.axes[0].velocity_m_s.value) &&
                          this->estimator().bank().noise_is_known();
  if (!has_motion) {
    for (int axis = 0; axis < kAxes; ++axis) {
      correctors_[axis].pass();
      expectations_[axis].is_open = false;
    }
    return;
  }
  find_lag(estimate.time_ns);
  TimeNs taught_ns = 0;
  Array<MotionMoments<Scalar>, kAxes> taught;
  const bool is_taught =
      lag_ > this->estimator().lag() && this->estimator().look_back(lag_, taught_ns, taught);
  for (int axis = 0; axis < kAxes; ++axis) {
    TaughtMotion<Scalar> motion;
    if (is_taught) {
      const auto& mean = taught[axis].mean;
      motion = {taught_ns, mean[kPosition], {mean[kVelocity], mean[kThird]}};
    }
    correct(axis, estimate, is_taught ? &motion : nullptr);
  }
}

template <class Sensor, class Scalar, int kAxes, int kMostLag, int kKernels>
void LearnedSensor<Sensor, Scalar, kAxes, kMostLag, kKernels>::correct(
    int axis, Estimate& estimate, const TaughtMotion<Scalar>* taught) {
  AxisEstimate<Scalar>& values = estimate.axes[axis];
  LearningCounts& counts = counts_[axis];
  const int late = this->estimator().lag();
  if (late == 0) compare(axis, values, estimate);
  const bool is_used = !estimate.events.has(Event::outlier_rejected) &&
                       std::isfinite(values.innovation_m) && values.innovation_sd_m > Scalar(0);
  const FilteredMotion<Scalar> filtered = {
      estimate.time_ns,
      values.position_m.value,
      {values.velocity_m_s.value, values.acceleration_m_s2.value},
      {values.velocity_m_s.standard_deviation, values.acceleration_m_s2.standard_deviation},
      std::isfinite(values.innovation_m) && values.innovation_sd_m > Scalar(0)
          ? values.innovation_m / values.innovation_sd_m
          : Scalar(0),
      std::isfinite(values.innovation_m) && values.innovation_sd_m > Scalar(0) && late == 0
          ? values.innovation_sd_m
          : Scalar(0),
      is_used ? values.measured_position_m : AxisEstimate<Scalar>::kNone};
  const CorrectedMotion<Scalar> corrected = correctors_[axis].step(filtered, taught, lag_ - late);
  ++counts.samples;
  if (correctors_[axis].is_coloured()) ++counts.silent_for_noise;
  expectations_[axis] = {estimate.time_ns,
                         {corrected.correction[0], corrected.correction[1]},
                         corrected.share[0] > Scalar(0)};
  if (corrected.share[0] > Scalar(0)) {
    ++counts.corrected;
    values.velocity_m_s.value += corrected.correction[0];
    values.velocity_m_s.standard_deviation = corrected.standard_deviation[0];
    values.velocity_learned = corrected.share[0];
  }
  if (corrected.share[1] > Scalar(0)) {
    values.acceleration_m_s2.value += corrected.correction[1];
    values.acceleration_m_s2.standard_deviation = corrected.standard_deviation[1];
    values.acceleration_learned = corrected.share[1];
    values.force_N.value = values.acceleration_m_s2.value * assumed_mass_kg_;
    values.force_N.standard_deviation =
        values.acceleration_m_s2.standard_deviation * assumed_mass_kg_;
  }
}

template <class Sensor, class Scalar, int kAxes, int kMostLag, int kKernels>
void LearnedSensor<Sensor, Scalar, kAxes, kMostLag, kKernels>::compare(
    int axis, const AxisEstimate<Scalar>& values, const Estimate& estimate) {
  const Expectation& expected = expectations_[axis];
  if (!expected.is_open || !std::isfinite(values.innovation_m)) return;
  if (is_unexpected(estimate.events)) return;
  const Scalar T = difference_s<Scalar>(estimate.time_ns, expected.time_ns);
  const Scalar left_m = values.innovation_m - expected.correction[0] * T -
                        expected.correction[1] * T * T * Scalar(0.5);
  LearningCounts& counts = counts_[axis];
  ++counts.compared;
  const auto of_filter_m = static_cast<double>(values.innovation_m);
  const auto of_corrected_m = static_cast<double>(left_m);
  counts.filter_square_m2 += of_filter_m * of_filter_m;
  counts.corrected_square_m2 += of_corrected_m * of_corrected_m;
}

template <class Sensor, class Scalar, int kAxes, int kMostLag, int kKernels>
void LearnedSensor<Sensor, Scalar, kAxes, kMostLag, kKernels>::find_lag(TimeNs time_ns) {
  if (has_time_) {
    Scalar T = difference_s<Scalar>(time_ns, time_ns_);
    if (steps_ >= Scalar(kFirstSteps)) T = std::min(T, 2 * mean_step_s_);
    steps_ = std::min(steps_ + Scalar(1), kStepMemory);
    mean_step_s_ += (T - mean_step_s_) / steps_;
  }
  time_ns_ = time_ns;
  has_time_ = true;
  if (steps_ < Scalar(kFirstSteps) || !(mean_step_s_ > Scalar(0))) return;
  const Scalar wanted = std::clamp(static_cast<Scalar>(kTeacher_s) / mean_step_s_, Scalar(2),
                                   static_cast<Scalar>(kMostLag));
  if (lag_ == 0 || std::abs(wanted - static_cast<Scalar>(lag_)) > Scalar(0.8)) {
    lag_ = static_cast<int>(wanted + Scalar(0.5));
  }
}

template <class Sensor, class Scalar, int kAxes, int kMostLag, int kKernels>
void LearnedSensor<Sensor, Scalar, kAxes, kMostLag, kKernels>::lose_motion() {
  for (int axis = 0; axis < kAxes; ++axis) {
    correctors_[axis].lose_motion();
    expectations_[axis].is_open = false;
  }
  has_time_ = false;
}

#ifdef CONDYLE_SENSORS_COMPILED  // once, in a library
extern template class LearnedSensor<RecommendedSensor<double, 1>, double, 1, 16, kMostKernels>;
extern template class LearnedSensor<RecommendedSensor<double, 3>, double, 3, 16, kMostKernels>;
extern template class LearnedSensor<DrivenSensor<double, 1>, double, 1, 16, kMostKernels>;
extern template class LearnedSensor<DrivenSensor<double, 3>, double, 3, 16, kMostKernels>;
extern template class LearnedSensor<RecommendedSensor<float, 1>, float, 1, 16, kMostKernels>;
extern template class LearnedSensor<RecommendedSensor<float, 3>, float, 3, 16, kMostKernels>;
extern template class LearnedSensor<DrivenSensor<float, 1>, float, 1, 16, kMostKernels>;
extern template class LearnedSensor<DrivenSensor<float, 3>, float, 3, 16, kMostKernels>;
#endif

}  // namespace condyle
