// SPDX-License-Identifier: Apache-2.0
// The recommended estimator: position, velocity and acceleration along up to three axes from
// measured positions and their times, and the net force for an assumed mass.
//
//   filter_bank.h        motion: exact white-jerk filters; noise and jerk density learned
//   outlier_gate.h       outliers: full weight, less, none
//   motion_hypotheses.h  outlier or change of the motion: both, until later samples decide
//   rounding_step.h      rounded positions, whose noise is no less than that of rounding
//   unseen_change.h      a change that has not shown yet: where nothing is taken, at a far sample
//   unseen_tremor.h      a tremor that the noise hides
//   fixed_lag.h          each estimate may wait for up to kMostLag later samples
//   force                assumed mass times acceleration
//
// One decision for all axes of a sample, because a glitch rarely affects only one. Time is taken
// from the samples, differences as integers. Without a measurement the filter predicts; after
// `longest_gap_s` without one it gives no values.
//
// Provenance. Information share (provenance.h) against the documented prior of velocity and
// acceleration, without growth: a value whose variance has fallen to half of the prior's is
// measured. If the sample of that instant was not used, the motion model carries over the
// neighbours' measurements: the value is derived, with white jerk as the named assumption. Force is
// derived from a measured or derived acceleration. Everything else is assumed, and so is everything
// while the noise, on which all standard deviations rest, is still a guess: for the first 15
// samples, and longer if the guess is far too low.
#pragma once

#include "condyle/estimator/motion/motion_instant.h"
#include "condyle/estimator/motion/recommended_estimate.h"
#include "condyle/estimator/motion/rounding_step.h"
#include "condyle/estimator/motion/unseen_tremor.h"

namespace condyle {

/// The recommended estimator for `kAxes` (1 or 3) axes. Estimates are `lag` samples late, at most
/// `kMostLag`. One object per run; copying it copies the run.
template <class Scalar, int kAxes, int kMostLag = 16>
class RecommendedEstimator {
 public:
  static_assert(kAxes == 1 || kAxes == 3);
  using Estimate = RecommendedEstimate<Scalar>;
  using Measurement = TimedPosition<Scalar, kAxes>;

  /// `parameters` must satisfy `is_valid`, `lag` must be 0 to kMostLag; otherwise every step has
  /// the event `parameters_invalid` and computes nothing.
  explicit RecommendedEstimator(const MotionEstimatorParameters& parameters, int lag = 0)
      : assumed_mass_kg_(static_cast<Scalar>(parameters.assumed_mass_kg)),
        prior_velocity_variance_(square(parameters.prior.velocity_sd_m_s)),
        prior_acceleration_variance_(square(parameters.prior.acceleration_sd_m_s2)),
        longest_gap_s_(static_cast<Scalar>(parameters.outliers.longest_gap_s)),
        lag_(lag),
        parameters_valid_(is_valid(parameters) && lag >= 0 && lag <= kMostLag),
        motion_(parameters),
        tremor_(prior_acceleration_variance_) {
    for (Scalar& sd_m : noise_sd_m_) sd_m = static_cast<Scalar>(parameters.noise.position_sd_m);
  }

  /// Noise of the instrument along each axis (m): that of the parameters unless it is set before
  /// the first measurement. With adaptation on it is a first guess.
  void set_noise(const Array<Scalar, kAxes>& noise_sd_m) {
    for (int axis = 0; axis < kAxes; ++axis) {
      noise_sd_m_[axis] = noise_sd_m[axis];
      const Scalar R = noise_sd_m[axis] * noise_sd_m[axis];
      parameters_valid_ =
          parameters_valid_ && noise_sd_m[axis] > Scalar(0) && R > Scalar(0) && std::isfinite(R);
    }
  }

  /// The next sample, whose time is known. A time before the last one is rejected
  /// (`time_reversed`). NaN, and a position beyond kLargestPosition_m, whose square exceeds float,
  /// enter no state (`position_missing`).
  Estimate step(const Measurement& measurement) {
    if (!parameters_valid_) return without_values(Event::parameters_invalid);
    Instant& instant = next_instant(measurement);
    if (has_time_ && measurement.time_ns < time_ns_) {
      instant.events.add(Event::time_reversed);
      return newest_ready();
    }
    const Scalar T = has_time_ ? difference_s<Scalar>(measurement.time_ns, time_ns_) : Scalar(0);
    time_ns_ = measurement.time_ns;
    has_time_ = true;
    if (started_ && difference_s<Scalar>(time_ns_, taken_ns_) > longest_gap_s_) lose_motion();
    if (started_) {
      instant.F = white_jerk_jacobian(T);
      motion_.predict(T, instant.F, white_jerk_covariance(T));
    }
    instant.is_measured = measurement.is_measured;
    for (const Scalar position_m : measurement.position_m) {
      instant.is_measured = instant.is_measured && std::abs(position_m) <= kLargestPosition_m;
    }
    doubt_repeat(measurement, instant);
    if (instant.is_measured) {
      take(T, instant);
    } else {
      instant.events.add(Event::position_missing,
                         measurement.is_measured && !instant.events.has(Event::position_repeated));
      instant.events.add(Event::not_started, !started_ && !is_lost_);
      instant.events.add(Event::state_lost, is_lost_);
    }
    for (int axis = 0; axis < kAxes; ++axis) {
      instant.rounding_variance_m2[axis] = rounding_[axis].lasting_variance_m2();
    }
    instant.has_state = started_;
    remember(instant);
    return newest_ready();
  }

  /// A sample with unknown position or time: it is passed on with its events, and the state stays.
  Estimate skip(const Measurement& measurement, bool time_valid) {
    if (!parameters_valid_) return without_values(Event::parameters_invalid);
    next_instant(measurement).time_valid = time_valid;
    return newest_ready();
  }

  /// The source's clock was set: the motion restarts with the next sample; the knowledge of the
  /// noise stays.
  void restart_clock() {
    has_time_ = false;
    if (started_) lose_motion();
  }

  /// The last `samples` samples came from a frozen device, though some were used: the motion is
  /// lost, and waiting estimates get no values.
  void forget_frozen(int samples) {
    instants_.forget_frozen(samples);
    if (started_) lose_motion();
  }

  /// After the last sample: the next estimate that was waiting for later samples. False if there is
  /// none left.
  [[nodiscard]] bool drain(Estimate& estimate) {
    if (waiting_ == 0) return false;
    estimate = estimate_of(--waiting_);
    return true;
  }

  /// From now on `look_back` is possible, also if no estimate waits for later samples.
  void keep_steps() { keeps_steps_ = true; }

  /// Motion `back` samples ago, 1 to kMostLag, from all samples up to now, and its time. False if
  /// it is not known.
  [[nodiscard]] bool look_back(int back, TimeNs& time_ns,
                               Array<MotionMoments<Scalar>, kAxes>& moments) const {
    const Instant& instant = instants_.at(back);
    if (!instant.has_state || !instant.time_valid) return false;
    time_ns = instant.time_ns;
    smooth(back, moments);
    return true;
  }

  /// Delay of an estimate in samples.
  int lag() const { return lag_; }
  /// The filters behind the estimate.
  const FilterBank<Scalar, kAxes>& bank() const { return motion_.main(); }
  /// Both hypotheses, if there are two.
  const MotionHypotheses<Scalar, kAxes>& motion() const { return motion_; }
  /// The rounding step of positions along `axis` (m); 0 if none was found.
  Scalar rounding_step_m(int axis) const { return rounding_[axis].step_m(); }

 private:
  static constexpr int kInstants = kMostLag + 1;
  static constexpr Scalar kLargestPosition_m = Scalar(1e6);
  using Bank = FilterBank<Scalar, kAxes>;
  using Instants = MotionInstants<Scalar, kAxes, kInstants>;
  using Instant = typename Instants::Instant;

  static Scalar square(double value) { return static_cast<Scalar>(value * value); }

  static Estimate without_values(Event event) {
    Estimate estimate;
    estimate.is_ready = true;
    estimate.events.add(event);
    return estimate;
  }

  Instant& next_instant(const Measurement& measurement) {
    waiting_ = std::min(waiting_ + 1, lag_ + 1);
    Instant& instant = instants_.advance();
    instant.time_ns = measurement.time_ns;
    instant.events = measurement.events;
    instant.track = motion_.main_index();
    for (int axis = 0; axis < kAxes; ++axis) {
      instant.position_m[axis] = measurement.position_m[axis];
    }
    return instant;
  }

  void lose_motion() {
    instants_.settle(motion_.main_index());
    motion_.lose_motion();
    started_ = false;
    is_lost_ = true;
  }

  // A moving jaw does not repeat its position. A repeat that contradicts the motion, and all
  // repeats that follow it, come from a device that stands still.
  void doubt_repeat(const Measurement& measurement, Instant& instant) {
    doubts_run_ = measurement.is_repeat &&
                  (doubts_run_ ||
                   (started_ && instant.is_measured && motion_.is_unexpected(instant.position_m)));
    if (!doubts_run_ || !instant.is_measured) return;
    instant.events.add(Event::position_repeated);
    instant.is_measured = false;
  }

  // Uses the measured position of `instant`, `T` s after the last sample.
  void take(Scalar T, Instant& instant) {
    for (int axis = 0; axis < kAxes; ++axis) rounding_[axis].add(instant.position_m[axis]);
    if (!started_) {
      start(instant);
      return;
    }
    for (int axis = 0; axis < kAxes; ++axis) {
      const Scalar step_m = rounding_[axis].step_m();
      motion_.hold_noise_above(axis, step_m * step_m / Scalar(12));
    }
    const auto verdict = motion_.take(instant.position_m, T);
    instant.events.add(verdict.events);
    for (int axis = 0; axis < kAxes; ++axis) {
      instant.innovation_m[axis] = verdict.innovation_m[axis];
      instant.innovation_variance_m2[axis] = verdict.variance_m2[axis];
    }
    for (int i = 0; i < 2; ++i) {
      instant.tracks[i].is_taken = verdict.is_taken[i];
      instant.tracks[i].is_restart = verdict.is_start[i];
    }
    instant.track = motion_.main_index();
    if (verdict.settled >= 0) instants_.settle(verdict.settled);
    if (verdict.is_known) taken_ns_ = instant.time_ns;
  }

  void remember(Instant& instant) {
    instant.is_open = started_ && motion_.has_other();
    if constexpr (kMostLag > 0) {
      if ((lag_ == 0 && !keeps_steps_) || !started_) return;
      const int main = motion_.main_index();
      for (int i = 0; i < motion_.main().member_count(); ++i) {
        instant.tracks[main].members[i] = motion_.main().step(i);
        if (instant.is_open) instant.tracks[1 - main].members[i] = motion_.other().step(i);
      }
    }
  }

  void start(Instant& instant) {
    if (!noise_started_) motion_.start_noise(noise_sd_m_);
    instant.events.add(Event::state_restarted, noise_started_);
    motion_.start_motion(instant.position_m);
    noise_started_ = started_ = true;
    is_lost_ = has_shown_ = false;
    instant.track = motion_.main_index();
    auto& track = instant.tracks[instant.track];
    instant.is_first = track.is_taken = track.is_restart = true;
    taken_ns_ = instant.time_ns;
  }

  // The estimate that has waited for `lag_` samples, if there is one yet.
  Estimate newest_ready() {
    if (waiting_ <= lag_) return {};
    waiting_ = lag_;
    return estimate_of(lag_);
  }

  // The estimate of the instant `back` samples ago, from all samples up to now.
  Estimate estimate_of(int back) {
    const Instant& instant = instants_.at(back);
    Estimate estimate;
    estimate.is_ready = true;
    estimate.time_ns = instant.time_ns;
    estimate.time_valid = instant.time_valid;
    estimate.axis_count = kAxes;
    estimate.events = instant.events;
    const int main = motion_.main_index();
    if (instant.is_measured) instant.describe_measurement(estimate);
    if (!instant.has_state) return estimate;
    Array<MotionMoments<Scalar>, kAxes> moments;
    if (back > 0) {
      smooth(back, moments);
    } else {
      filter(instant, moments);
    }
    const bool is_taken = instant.seen_by(main).is_taken ||
                          (instant.is_open && instant.events.has(Event::motion_changed));
    for (int axis = 0; axis < kAxes; ++axis) {
      describe_state(moments[axis], is_taken, estimate.axes[axis], estimate.events);
      estimate.axes[axis].noise_sd_m = std::sqrt(bank().noise_variance_m2(axis));
      estimate.axes[axis].jerk_density_m2_s5 = bank().jerk_density_m2_s5(axis);
      estimate.events.add(Event::noise_at_limit, bank().noise_is_at_limit(axis));
      estimate.events.add(Event::liveliness_at_limit, bank().jerk_density_is_at_limit(axis));
    }
    return estimate;
  }

  // Motion at the newest instant. Without a measurement, no value becomes better known.
  void filter(const Instant& instant, Array<MotionMoments<Scalar>, kAxes>& moments) {
    const bool is_taken = instant.tracks[0].is_taken || instant.tracks[1].is_taken;
    const bool is_unexpected = instant.is_measured && instant.events.has(Event::outlier_rejected);
    for (int axis = 0; axis < kAxes; ++axis) {
      moments[axis] = motion_.moments(axis);
      widen(0, axis, nullptr, moments[axis]);
      Vector3<Scalar>& variance = moments[axis].variance;
      if (is_taken && !instant.is_first && bank().is_adaptive()) {
        variance[kVelocity] += motion_.onset_variance(
            instant.innovation_m[axis], instant.innovation_variance_m2[axis], instant.F.pv);
      }
      if (has_shown_ && (!is_taken || is_unexpected)) {
        variance = variance.cwiseMax(shown_variance_[axis]);
      }
      shown_variance_[axis] = variance;
    }
    has_shown_ = true;
  }

  // Adds to the motion `back` samples ago what no filter of the bank knows of: rounding at rest, a
  // tremor, and, if no sample has been used since, a change of the motion. `smoothed`: by main's
  // members, null if nothing was smoothed.
  void widen(int back, int axis, const typename Instants::Smoothed* smoothed,
             MotionMoments<Scalar>& moments) const {
    if (!bank().is_adaptive()) return;
    const Instant& instant = instants_.at(back);
    const int main = motion_.main_index();
    moments.variance[kPosition] += instant.rounding_variance_m2[axis];
    const auto filter = [&](int i) -> FilterShown<Scalar> {
      if (smoothed == nullptr) return shown_by_itself(bank().step(i).P);
      return {instant.seen_by(main).members[i].P, (*smoothed)[i][axis].variance};
    };
    moments.variance += tremor_.of_bank(bank(), axis, filter, instants_.later_s(main, back));
    if (instant.time_ns <= taken_ns_) return;
    moments.variance += motion_.gap_variance(difference_s<Scalar>(instant.time_ns, taken_ns_));
  }

  // Motion `back` samples ago, from all samples since.
  void smooth(int back, Array<MotionMoments<Scalar>, kAxes>& moments) const {
    typename Instants::Smoothed smoothed;
    instants_.smooth(motion_.main(), motion_.main_index(), back, smoothed);
    const auto member = [&](int axis) { return [&, axis](int i) { return smoothed[i][axis]; }; };
    for (int axis = 0; axis < kAxes; ++axis) {
      moments[axis] = motion_.main().mixture(axis, member(axis));
      widen(back, axis, &smoothed, moments[axis]);
    }
    if (!(motion_.share_of_other() > Scalar(0))) return;
    instants_.smooth(motion_.other(), 1 - motion_.main_index(), back, smoothed);
    for (int axis = 0; axis < kAxes; ++axis) {
      moments[axis] = motion_.mixture(moments[axis], motion_.other().mixture(axis, member(axis)));
    }
  }

  void describe_state(const MotionMoments<Scalar>& moments, bool is_taken,
                      AxisEstimate<Scalar>& described, EventSet& events) const {
    for (int i = 0; i < 3; ++i) {
      events.add(Event::estimate_not_finite,
                 !std::isfinite(moments.mean[i]) || !std::isfinite(moments.variance[i]));
      events.add(Event::variance_negative, moments.variance[i] < Scalar(0));
    }
    const auto unless_guessed = [&](Provenance provenance) {
      return bank().noise_is_known() ? carried_over(provenance, is_taken) : Provenance::assumed;
    };
    const auto provenance = [&](StateIndex i, Scalar prior_variance) {
      return unless_guessed(
          provenance_of_share(information_share(moments.variance[i], prior_variance)));
    };
    described.position_m = quantity_of(moments.mean[kPosition], moments.variance[kPosition],
                                       unless_guessed(Provenance::measured));
    described.velocity_m_s = quantity_of(moments.mean[kVelocity], moments.variance[kVelocity],
                                         provenance(kVelocity, prior_velocity_variance_));
    described.acceleration_m_s2 = quantity_of(moments.mean[kThird], moments.variance[kThird],
                                              provenance(kThird, prior_acceleration_variance_));
    described.force_N = described.acceleration_m_s2;
    described.force_N.value *= assumed_mass_kg_;
    described.force_N.standard_deviation *= assumed_mass_kg_;
    if (described.force_N.provenance == Provenance::measured) {
      described.force_N.provenance = Provenance::derived;
    }
  }

  Scalar assumed_mass_kg_, prior_velocity_variance_, prior_acceleration_variance_;
  Scalar longest_gap_s_;
  int lag_;
  bool keeps_steps_ = false;
  bool parameters_valid_;
  MotionHypotheses<Scalar, kAxes> motion_;
  UnseenTremor<Scalar> tremor_;
  Array<RoundingStep<Scalar>, kAxes> rounding_;
  Array<Scalar, kAxes> noise_sd_m_;
  bool has_time_ = false;       // a sample's time is known,
  TimeNs time_ns_ = 0;          // the last one's
  TimeNs taken_ns_ = 0;         // of the last sample that was used
  bool noise_started_ = false;  // a position was used before
  bool started_ = false;        // there is a state,
  bool is_lost_ = false;        // or there was one
  bool doubts_run_ = false;     // the repeats since the last change are not used
  int waiting_ = 0;
  bool has_shown_ = false;                        // an estimate of the newest instant,
  Array<Vector3<Scalar>, kAxes> shown_variance_;  // with these variances
  Instants instants_;
};

}  // namespace condyle
