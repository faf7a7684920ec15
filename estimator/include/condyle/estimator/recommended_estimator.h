// SPDX-License-Identifier: Apache-2.0
// The recommended estimator: position, velocity and acceleration along up to three axes from
// measured positions and their times, and the net force that an assumed mass makes of them.
//
//   motion_bank.h    motion: exact white-jerk filters; noise and liveliness learned from the data
//   outlier_gate.h   outliers: full weight, less, none, then a new start
//   fixed_lag.h      each estimate may wait for up to kMostLag later samples
//   force            assumed mass times acceleration
//
// One decision for all axes of a sample: a glitch rarely keeps to one. Time is taken from the
// samples, differences as integers. Where nothing was measured the filter predicts, and after
// `longest_gap_s` without a measurement it says nothing.
//
// Provenance. Information share (provenance.h) against the documented prior of velocity and
// acceleration, without growth: a value whose variance has come down to half of the prior's is
// measured. Where the sample of that instant was not taken, it is the motion model that carries the
// neighbours' measurements over: derived, the named assumption being white jerk. Force is derived
// from a measured or derived acceleration. All else is assumed; so is everything while the noise,
// on which all standard deviations rest, is still guessed: for the first 15 samples and longer
// where the guess is far too low.
#pragma once

#include "condyle/estimator/events.h"
#include "condyle/estimator/motion_bank.h"
#include "condyle/estimator/outlier_gate.h"
#include "condyle/estimator/provenance.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// What is said of one axis at one instant. NaN and `not_computed` where there is no value.
template <class Scalar>
struct AxisEstimate {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();

  Quantity<Scalar> position_m, velocity_m_s, acceleration_m_s2, force_N;
  Scalar measured_position_m = kNone;  ///< as it came in
  Scalar innovation_m = kNone;         ///< measured minus predicted position
  Scalar innovation_sd_m = kNone;      ///< its standard deviation, predicted
  Scalar noise_sd_m = kNone;           ///< of the instrument, as estimated or given
  Scalar jerk_density_m2_s5 = kNone;   ///< of the motion, as estimated or given
};

/// What one step says about one instant.
template <class Scalar>
struct RecommendedEstimate {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();

  bool is_ready = false;    ///< false while the lag fills: there is nothing to show yet
  TimeNs time_ns = 0;       ///< the instant that is estimated
  bool time_valid = false;  ///< its time is known
  int axis_count = 0;
  AxisEstimate<Scalar> axes[3];
  Scalar nis = kNone;  ///< normalised innovation squared, one degree of freedom per axis
  EventSet events;     ///< what was unusual about the sample of that instant
};

/// A measured position and its time.
template <class Scalar, int kAxes>
struct TimedPosition {
  TimeNs time_ns = 0;
  bool is_measured = false;  ///< false: the position is missing and the filter only predicts
  Array<Scalar, kAxes> position_m = {};
  EventSet events;  ///< what was unusual about the sample; passed on
};

/// The recommended estimator for `kAxes` (1 or 3) axes. Estimates are of `lag` samples ago, at most
/// `kMostLag`. One object per run; copying it copies the run.
template <class Scalar, int kAxes, int kMostLag = 16>
class RecommendedEstimator {
 public:
  static_assert(kAxes == 1 || kAxes == 3);
  using Estimate = RecommendedEstimate<Scalar>;
  using Measurement = TimedPosition<Scalar, kAxes>;

  /// `parameters` must satisfy `is_valid`, `lag` be 0 to kMostLag; otherwise every step says
  /// `parameters_invalid` and computes nothing.
  explicit RecommendedEstimator(const RecommendedParameters& parameters, int lag = 0)
      : assumed_mass_kg_(static_cast<Scalar>(parameters.assumed_mass_kg)),
        prior_velocity_variance_(square(parameters.prior.velocity_sd_m_s)),
        prior_acceleration_variance_(square(parameters.prior.acceleration_sd_m_s2)),
        longest_gap_s_(static_cast<Scalar>(parameters.outliers.longest_gap_s)),
        lag_(lag),
        parameters_valid_(is_valid(parameters) && lag >= 0 && lag <= kMostLag),
        bank_(parameters),
        gate_(parameters.outliers),
        without_suspect_(parameters) {
    for (Scalar& sd_m : noise_sd_m_) sd_m = static_cast<Scalar>(parameters.noise.position_sd_m);
  }

  /// Noise of the instrument along each axis (m): that of the parameters unless set before the
  /// first measurement. With adaptation on it is a first guess.
  void set_noise(const Array<Scalar, kAxes>& noise_sd_m) {
    for (int axis = 0; axis < kAxes; ++axis) {
      noise_sd_m_[axis] = noise_sd_m[axis];
      const Scalar R = noise_sd_m[axis] * noise_sd_m[axis];
      parameters_valid_ =
          parameters_valid_ && noise_sd_m[axis] > Scalar(0) && R > Scalar(0) && std::isfinite(R);
    }
  }

  /// The next sample, whose time is known. A time before the last one is not taken
  /// (`time_reversed`); NaN or infinity enters no state (`position_missing`).
  Estimate step(const Measurement& measurement) {
    if (!parameters_valid_) return without_values(Event::parameters_invalid);
    Instant& instant = next_instant(measurement);
    if (has_time_ && measurement.time_ns < time_ns_) {
      instant.events.add(Event::time_reversed);
      return newest_ready();
    }
    const Scalar T = has_time_ ? difference_s(measurement.time_ns, time_ns_) : Scalar(0);
    time_ns_ = measurement.time_ns;
    has_time_ = true;
    if (started_ && difference_s(time_ns_, taken_ns_) > longest_gap_s_) lose_motion();
    if (started_) {
      instant.F = white_jerk_jacobian(T);
      bank_.predict(instant.F, white_jerk_covariance(T));
    }
    instant.is_measured = measurement.is_measured;
    for (const Scalar position_m : measurement.position_m) {
      instant.is_measured = instant.is_measured && std::isfinite(position_m);
    }
    if (instant.is_measured) {
      take(T, instant);
    } else {
      instant.events.add(Event::position_missing, measurement.is_measured);
      instant.events.add(Event::not_started, !started_ && !is_lost_);
      instant.events.add(Event::state_lost, is_lost_);
    }
    instant.has_state = started_;
    remember(bank_, instant);
    return newest_ready();
  }

  /// A sample that cannot be used, its position or time unknown: it is passed on, with its events,
  /// and the state stays.
  Estimate skip(const Measurement& measurement, bool time_valid) {
    if (!parameters_valid_) return without_values(Event::parameters_invalid);
    next_instant(measurement).time_valid = time_valid;
    return newest_ready();
  }

  /// The source's clock was set: the motion starts anew with the next sample; what is known of the
  /// noise stays.
  void restart_clock() {
    has_time_ = false;
    if (started_) lose_motion();
  }

  /// The last `samples` samples turn out to come from a frozen device, though some were taken: the
  /// motion is lost, and nothing is said of those that still wait.
  void forget_frozen(int samples) {
    for (int back = 0; back < std::min(samples, kInstants); ++back) {
      Instant& instant = at(back);
      instant.events.add(Event::position_frozen);
      instant.events.add(Event::state_lost);
      instant.is_taken = instant.has_state = false;
      instant.is_restart = true;  // nothing connects what is before with what is after
    }
    if (started_) lose_motion();
  }

  /// After the last sample: the next of the estimates that still waited for later samples. False
  /// where there is none left.
  [[nodiscard]] bool drain(Estimate& estimate) {
    if (waiting_ == 0) return false;
    estimate = estimate_of(--waiting_);
    return true;
  }

  /// Samples that an estimate lies behind.
  int lag() const { return lag_; }
  /// The filters behind the estimate.
  const MotionBank<Scalar, kAxes>& bank() const { return bank_; }

 private:
  using Bank = MotionBank<Scalar, kAxes>;

  // One sample and what was made of it.
  struct Instant {
    TimeNs time_ns = 0;
    bool time_valid = true;
    bool is_measured = false;  // a position came in
    bool is_taken = false;     // and was used
    bool is_restart = false;   // nothing connects it with what was before
    bool has_state = false;
    EventSet events;
    Array<Scalar, kAxes> position_m = {};
    Array<Scalar, kAxes> innovation_m = {};
    Array<Scalar, kAxes> innovation_variance_m2 = {};
    TransitionJacobian<Scalar> F;  // from the sample before
    Array<typename Bank::Step, (kMostLag > 0 ? Bank::kMostMembers : 1)> members;
  };

  static Scalar square(double value) { return static_cast<Scalar>(value * value); }

  // Unsigned, because the difference of two far times can leave int64.
  static Scalar difference_s(TimeNs later_ns, TimeNs earlier_ns) {
    const std::uint64_t difference_ns =
        static_cast<std::uint64_t>(later_ns) - static_cast<std::uint64_t>(earlier_ns);
    return static_cast<Scalar>(static_cast<double>(difference_ns) * 1e-9);
  }

  static Estimate without_values(Event event) {
    Estimate estimate;
    estimate.is_ready = true;
    estimate.events.add(event);
    return estimate;
  }

  // The instant `back` samples before the newest.
  Instant& at(int back) { return instants_[(newest_ + kInstants - back) % kInstants]; }

  Instant& next_instant(const Measurement& measurement) {
    newest_ = (newest_ + 1) % kInstants;
    if (suspect_back_ >= 0) ++suspect_back_;
    waiting_ = std::min(waiting_ + 1, lag_ + 1);
    Instant& instant = at(0);
    instant.time_ns = measurement.time_ns;
    instant.time_valid = true;
    instant.is_measured = instant.is_taken = instant.is_restart = instant.has_state = false;
    instant.events = measurement.events;
    instant.F = white_jerk_jacobian(Scalar(0));
    for (int axis = 0; axis < kAxes; ++axis)
      instant.position_m[axis] = measurement.position_m[axis];
    return instant;
  }

  void lose_motion() {
    suspect_back_ = -1;
    started_ = false;
    is_lost_ = true;
  }

  // Takes the measured position of `instant`, `T` s after the last sample.
  void take(Scalar T, Instant& instant) {
    if (!started_) {
      start(instant);
      return;
    }
    Deviation deviation = compare(bank_, instant);
    if (gate_.is_outlier(deviation.of_likely) && suspect_back_ > 0) {
      if (revoke_suspect(instant)) instant.events.add(Event::outlier_revoked);
      deviation = compare(bank_, instant);
    }
    const Acceptance<Scalar> acceptance = gate_.judge(deviation.of_likely);
    instant.events.add(acceptance.events);
    suspect_back_ = -1;
    if (acceptance.weight > Scalar(0) && gate_.is_doubtful(deviation.of_mixture)) {
      suspect_back_ = 0;
      without_suspect_ = bank_;
      taken_before_suspect_ns_ = taken_ns_;
    }
    // One rejected sample is a glitch and says nothing of the noise; two in a row may be a noise,
    // or a motion, larger than was thought.
    if (gate_.rejections() != 1) bank_.learn(instant.position_m, T);
    if (acceptance.restart) {
      start(instant);
    } else if (acceptance.weight > Scalar(0)) {
      instant.events.add(Event::update_refused,
                         !bank_.update(instant.position_m, acceptance.weight));
      instant.is_taken = true;
      taken_ns_ = instant.time_ns;
    }
  }

  // Squared deviations from what was expected, the largest of all axes.
  struct Deviation {
    Scalar of_likely = 0;   // from the likely member that it fits best
    Scalar of_mixture = 0;  // from the mixture
  };

  // Compares `instant` with what `bank` expected of it, and notes that in `instant`.
  static Deviation compare(const Bank& bank, Instant& instant) {
    Deviation deviation;
    // So that NaN is the largest.
    const auto enlarge = [](Scalar& largest, Scalar value) {
      if (!(value <= largest)) largest = value;
    };
    for (int axis = 0; axis < kAxes; ++axis) {
      const auto expected = bank.expectation(axis, instant.position_m[axis]);
      const Scalar innovation_m = instant.position_m[axis] - expected.position_m;
      instant.innovation_m[axis] = innovation_m;
      instant.innovation_variance_m2[axis] = expected.variance_m2;
      enlarge(deviation.of_likely, expected.of_likely_squared);
      enlarge(deviation.of_mixture, expected.of_mixture_squared);
    }
    return deviation;
  }

  // The sample taken last was doubtful, and now `instant` is an outlier: if it is none without that
  // sample, that sample was one. Then the filter goes on as if it had not been taken.
  bool revoke_suspect(Instant& instant) {
    Bank without = without_suspect_;
    const Scalar T = difference_s(instant.time_ns, taken_ns_);
    without.predict(white_jerk_jacobian(T), white_jerk_covariance(T));
    if (gate_.is_doubtful(compare(without, instant).of_mixture)) return false;
    bank_ = without;
    taken_ns_ = taken_before_suspect_ns_;
    if (suspect_back_ >= kInstants) return true;
    Instant& suspect = at(suspect_back_);
    suspect.is_taken = false;
    suspect.events.add(Event::outlier_rejected);
    for (int back = suspect_back_; back > 0; --back) {
      Instant& past = at(back);
      if (back < suspect_back_) {
        without_suspect_.predict(past.F, white_jerk_covariance(past.F.vx));
      }
      remember(without_suspect_, past);
    }
    return true;
  }

  void remember(const Bank& bank, Instant& instant) const {
    if constexpr (kMostLag > 0) {
      for (int i = 0; lag_ > 0 && i < bank.member_count(); ++i) instant.members[i] = bank.step(i);
    }
  }

  void start(Instant& instant) {
    if (!noise_started_) bank_.start_noise(noise_sd_m_);
    instant.events.add(Event::state_restarted, noise_started_);
    bank_.start_motion(instant.position_m);
    gate_.restart();
    suspect_back_ = -1;
    noise_started_ = started_ = true;
    is_lost_ = false;
    instant.is_taken = instant.is_restart = true;
    taken_ns_ = instant.time_ns;
  }

  // The estimate that has waited for `lag_` samples, if there is one yet.
  Estimate newest_ready() {
    if (waiting_ <= lag_) return {};
    waiting_ = lag_;
    return estimate_of(lag_);
  }

  // The estimate of the instant `back` samples ago, by all samples up to now.
  Estimate estimate_of(int back) {
    const Instant& instant = at(back);
    Estimate estimate;
    estimate.is_ready = true;
    estimate.time_ns = instant.time_ns;
    estimate.time_valid = instant.time_valid;
    estimate.axis_count = kAxes;
    estimate.events = instant.events;
    if (instant.is_measured) describe_measurement(instant, estimate);
    if (!instant.has_state) return estimate;
    Array<Array<MotionMoments<Scalar>, kAxes>, Bank::kMostMembers> smoothed;
    if (back > 0) smooth(back, smoothed);
    for (int axis = 0; axis < kAxes; ++axis) {
      describe_state(back == 0 ? bank_.moments(axis)
                               : bank_.mixture(axis, [&](int i) { return smoothed[i][axis]; }),
                     instant.is_taken, estimate.axes[axis], estimate.events);
      estimate.axes[axis].noise_sd_m = std::sqrt(bank_.noise_variance_m2(axis));
      estimate.axes[axis].jerk_density_m2_s5 = bank_.jerk_density_m2_s5(axis);
      estimate.events.add(Event::noise_at_limit, bank_.noise_is_at_limit(axis));
    }
    return estimate;
  }

  void smooth(int back, Array<Array<MotionMoments<Scalar>, kAxes>, Bank::kMostMembers>& smoothed) {
    for (int i = 0; i < bank_.member_count(); ++i) {
      if (!bank_.is_plausible(i)) continue;
      LaterEvidence<Scalar, kAxes> evidence;
      for (int j = 0; j < back; ++j) {
        const Instant& later = at(j);
        if (later.is_restart) {
          evidence.forget();
        } else {
          if (later.is_taken) evidence.go_back_over_measurement(later.members[i]);
          evidence.go_back_over_step(later.F);
        }
      }
      const auto& step = at(back).members[i];
      for (int axis = 0; axis < kAxes; ++axis) {
        smoothed[i][axis] = evidence.smoothed(step, axis);
      }
    }
  }

  static void describe_measurement(const Instant& instant, Estimate& estimate) {
    Scalar nis = 0;
    bool has_nis = !instant.is_restart;
    for (int axis = 0; axis < kAxes; ++axis) {
      AxisEstimate<Scalar>& described = estimate.axes[axis];
      described.measured_position_m = instant.position_m[axis];
      const Scalar variance_m2 = instant.innovation_variance_m2[axis];
      has_nis = has_nis && variance_m2 > Scalar(0) && std::isfinite(variance_m2);
      if (!has_nis) continue;
      described.innovation_m = instant.innovation_m[axis];
      described.innovation_sd_m = std::sqrt(variance_m2);
      nis += instant.innovation_m[axis] * instant.innovation_m[axis] / variance_m2;
    }
    if (has_nis) estimate.nis = nis;
  }

  void describe_state(const MotionMoments<Scalar>& moments, bool is_taken,
                      AxisEstimate<Scalar>& described, EventSet& events) const {
    for (int i = 0; i < 3; ++i) {
      events.add(Event::estimate_not_finite,
                 !std::isfinite(moments.mean[i]) || !std::isfinite(moments.variance[i]));
      events.add(Event::variance_negative, moments.variance[i] < Scalar(0));
    }
    const auto unless_guessed = [&](Provenance provenance) {
      return bank_.noise_is_known() ? carried(provenance, is_taken) : Provenance::assumed;
    };
    const auto provenance = [&](StateIndex i, Scalar prior_variance) {
      return unless_guessed(
          provenance_of_share(information_share(moments.variance[i], prior_variance)));
    };
    described.position_m = quantity(moments, kPosition, unless_guessed(Provenance::measured));
    described.velocity_m_s =
        quantity(moments, kVelocity, provenance(kVelocity, prior_velocity_variance_));
    described.acceleration_m_s2 =
        quantity(moments, kThird, provenance(kThird, prior_acceleration_variance_));
    described.force_N = described.acceleration_m_s2;
    described.force_N.value *= assumed_mass_kg_;
    described.force_N.standard_deviation *= assumed_mass_kg_;
    if (described.force_N.provenance == Provenance::measured) {
      described.force_N.provenance = Provenance::derived;
    }
  }

  // Where the instant's own sample was not taken, the motion model carries the others' over.
  static Provenance carried(Provenance provenance, bool is_taken) {
    return provenance == Provenance::measured && !is_taken ? Provenance::derived : provenance;
  }

  // No value without a standard deviation, nor the other way round.
  static Quantity<Scalar> quantity(const MotionMoments<Scalar>& moments, StateIndex i,
                                   Provenance provenance) {
    const Scalar variance = moments.variance[i];
    if (!std::isfinite(moments.mean[i]) || !std::isfinite(variance) || variance < Scalar(0))
      return {};
    return {moments.mean[i], std::sqrt(variance), provenance};
  }

  static constexpr int kInstants = kMostLag + 1;

  Scalar assumed_mass_kg_, prior_velocity_variance_, prior_acceleration_variance_;
  Scalar longest_gap_s_;
  int lag_;
  bool parameters_valid_;
  Bank bank_;
  OutlierGate<Scalar> gate_;
  Array<Scalar, kAxes> noise_sd_m_;
  bool has_time_ = false;       // a sample's time is known,
  TimeNs time_ns_ = 0;          // the last one's
  TimeNs taken_ns_ = 0;         // of the last sample that was used
  bool noise_started_ = false;  // a position was ever taken
  bool started_ = false;        // there is a state,
  bool is_lost_ = false;        // or there was one
  int newest_ = 0, waiting_ = 0;
  int suspect_back_ = -1;  // samples since one that was taken though doubtful; -1: none
  Bank without_suspect_;   // as it would be had that one not been taken
  TimeNs taken_before_suspect_ns_ = 0;
  Array<Instant, kInstants> instants_;
};

}  // namespace condyle
