// SPDX-License-Identifier: Apache-2.0
// Corrects velocity and acceleration of a filter along one axis by what it has learned from the
// recording itself: kernel_regression.h learns the filter's error from what the same filter says
// `lag` samples later (the teacher), and predicts it for the present sample.
//
//   p, v, a, s    filtered position, velocity, acceleration, and a standard deviation
//   u             innovation in standard deviations, 0 without a measurement
//   pL, vL, aL    smoothed motion `lag` samples ago, t_L s before now
//   v[t]          vL of the instant t s ago, from memory; 0 before the first
//   mp, sp, sv, sa  running mean of pL and root mean squares of pL - mp, vL, aL, over 10 s
//
// Features, each ratio limited to +-5:
//   place    v/sv, 3 (v - vL - aL t_L)/sv, 0.7 (p - mp)/sp, 0.3 u, 0.5 aL/sa,
//            0.7 v[0.1]/sv, 0.7 v[0.167]/sv, 0.5 v[0.267]/sv
//   further  0.3 u of this and the seven samples before, 0.7 v[0.4, 0.55, 0.7, 0.85]/sv
//
// Correction of an output x (velocity or acceleration) by the regression's g:
//   G     clamp((nearness - 0.15)/0.3, 0, 1): has such a place been seen?
//   alpha share of g that past errors confirm (output_trust.h), 0 to 1
//   beta  largest share that the next positions do not contradict, 0 to 1: a teacher may err
//   su    mean of s over 10 s: far above it the filter has not settled
//   d   = min(alpha, beta) G clamp(3 - s/su, 0, 1) clamp(g, -3 s, 3 s), less at a surprise;  x + d
// Interval.  s stays: what the teacher confirms narrows nothing. An instrument that smooths or
//            delays its positions makes filter and teacher wrong alike, and positions need not show
//            it. The corrected value is then as wrong as the filter's, not more.
// Surprise.  m = max(e^2, m / (1 + T/0.1 s)), e: u less what the last correction has announced of
//            it. The variance becomes s^2 + k d^2, k = clamp((m - 2)/2, 0, 1), and the share is
//            multiplied by 1 - clamp((m - 4)/4, 0, 1). At an impact the velocity jumps between
//            samples, and the teacher, sure of itself, smooths the jump.
// Silence.   The filter's values stay, with their intervals, until kFirst samples are learned, and
//            while innovations or positions show that the noise is not white
//            (innovation_monitor.h): the teacher is then as wrong as the filter.
//
// Memory is lost with the motion; what was learned stays, and alpha tells whether it still holds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "condyle/estimator/math/innovation_monitor.h"
#include "condyle/estimator/motion/kernel_regression.h"
#include "condyle/estimator/motion/output_trust.h"
#include "condyle/estimator/motion/velocity_history.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// The filter's motion at a sample, without correction.
template <class Scalar>
struct FilteredMotion {
  TimeNs time_ns = 0;
  Scalar position_m = 0;
  Array<Scalar, 2> value = {};               ///< velocity (m/s), acceleration (m/s^2)
  Array<Scalar, 2> standard_deviation = {};  ///< theirs
  Scalar standardised_innovation = 0;        ///< u
  Scalar innovation_sd_m = 0;                ///< 0 if there is no innovation
  Scalar measured_position_m = 0;            ///< NaN if none was used
};

/// The motion some samples ago, from all samples since.
template <class Scalar>
struct TaughtMotion {
  TimeNs time_ns = 0;
  Scalar position_m = 0;
  Array<Scalar, 2> value = {};  ///< velocity, acceleration
};

/// The corrected motion.
template <class Scalar>
struct CorrectedMotion {
  Array<Scalar, 2> correction = {};          ///< to add to velocity and acceleration
  Array<Scalar, 2> standard_deviation = {};  ///< of the corrected values
  Array<Scalar, 2> share = {};               ///< of g that was used, 0 to 1
};

/// The corrector. `kMostKernels`: kernels for which there is memory; `kMostLag`: longest lag of the
/// teacher (samples).
template <class Scalar, int kMostKernels, int kMostLag = 16>
class MotionCorrector {
 public:
  using Filtered = FilteredMotion<Scalar>;
  using Taught = TaughtMotion<Scalar>;
  using Corrected = CorrectedMotion<Scalar>;

  /// Uses at most `kernels` kernels, 0 to kMostKernels. Call it before the first sample.
  void limit_kernels(int kernels) { regression_.limit_kernels(kernels); }

  /// What was learned, without the motion: calls `visit(name, first, count)` for each array. To
  /// begin with what an earlier recording has taught, call `begin_with` with its kernels, and let
  /// `visit` set the values: finite, squares and diagonal of the covariance positive. They are
  /// trusted once kFirst errors of this recording have confirmed them.
  template <class Visitor>
  void visit_learned(Visitor&& visit) {
    visit("position_square_m2", &position_square_, 1);
    visit("squares", &square_[0], kOutputs);
    regression_.visit_learned(visit);
  }
  void begin_with(int kernels) {
    regression_.begin_with(kernels);
    has_scales_ = true;
  }

  /// Forgets the motion, of which the next sample is the first, but not what was learned.
  void lose_motion() {
    kept_count_ = 0;
    history_.clear();
    has_taught_ = false;
    surprise_ = 0;
    for (Scalar& innovation : innovations_) innovation = 0;
  }

  /// A sample without a motion.
  void pass() { keep() = Kept(); }

  /// The next sample. `taught`: the motion `lag` samples ago, which must have been given as
  /// `filtered` then; null if it is not known.
  Corrected step(const Filtered& filtered, const Taught* taught, int lag) {
    const Scalar T = has_time_ ? difference_s<Scalar>(filtered.time_ns, time_ns_) : Scalar(0);
    time_ns_ = filtered.time_ns;
    has_time_ = true;
    const Scalar u = std::clamp(filtered.standardised_innovation, -kMostRatio, kMostRatio);
    for (int i = kInnovations - 1; i > 0; --i) innovations_[i] = innovations_[i - 1];
    innovations_[0] = u;
    const Scalar e = std::clamp(filtered.standardised_innovation - announced(filtered, T),
                                -kMostRatio, kMostRatio);
    surprise_ = std::max(e * e, surprise_ / (Scalar(1) + T / kSurprise_s));
    monitor_.add(std::isfinite(filtered.measured_position_m)
                     ? filtered.standardised_innovation
                     : std::numeric_limits<Scalar>::quiet_NaN(),
                 filtered.measured_position_m, T);
    if (++watched_ % kWatch == 0) is_coloured_ = monitor_.is_correlated() || monitor_.is_filtered();
    if (std::isfinite(filtered.measured_position_m)) hear_position(filtered, T);
    has_taught_ = taught != nullptr && T > Scalar(0);
    if (has_taught_) {
      take_scales(*taught, T);
      history_.add(taught->time_ns, taught->value[0]);
      if (lag <= kept_count_) learn(kept_[index_of(lag)], *taught, T);
    }
    return correct(filtered, taught);
  }

  /// True while the noise is not white, so that nothing is corrected.
  bool is_coloured() const { return is_coloured_; }
  /// Samples from which it learned.
  int learned() const { return trust_[0].count(); }
  /// Kernels in use.
  int kernels() const { return regression_.used(); }

 private:
  using Regression = KernelRegression<Scalar, kMostKernels>;
  using Features = typename Regression::Features;
  static constexpr int kOutputs = Regression::kOutputs, kInnovations = 8;
  static constexpr int kKept = kMostLag + 1, kWatch = 64;
  static constexpr Scalar kMostRatio = 5, kMostCorrection = 3, kScale_s = 10;
  static constexpr Scalar kSurprise_s = Scalar(0.1), kLearnStep_s = Scalar(0.009);

  // What a sample was, until its teacher comes.
  struct Kept {
    bool is_usable = false;
    Features features = {};
    Array<Scalar, kOutputs> value = {}, deviation = {}, scale = {}, predicted = {}, given = {};
    Scalar gate = 0;
  };

  // Place for a new sample.
  Kept& keep() {
    newest_ = (newest_ + 1) % kKept;
    kept_count_ = std::min(kept_count_ + 1, kKept);
    return kept_[newest_];
  }
  // Of the sample that was kept `back` samples before the one that is not kept yet.
  int index_of(int back) const { return (newest_ + kKept - back + 1) % kKept; }

  void take_scales(const Taught& taught, Scalar T) {
    if (scale_count_ == Scalar(0)) mean_position_m_ = taught.position_m;
    const Scalar most = std::max(kScale_s / T, Scalar(1));
    scale_count_ = std::min(scale_count_ + Scalar(1), most);
    mean_position_m_ += (taught.position_m - mean_position_m_) / (scale_count_ + Scalar(1));
    const Scalar gain = Scalar(1) / ((has_scales_ ? most : scale_count_) + Scalar(1));
    const Scalar p = taught.position_m - mean_position_m_;
    position_square_ += (p * p - position_square_) * gain;
    for (int i = 0; i < kOutputs; ++i) {
      square_[i] += (taught.value[i] * taught.value[i] - square_[i]) * gain;
      scale_[i] = std::sqrt(square_[i]);
    }
    position_scale_m_ = std::sqrt(position_square_);
  }

  // `was` is the sample that `taught` is about.
  void learn(const Kept& was, const Taught& taught, Scalar T) {
    waiting_s_ += T;
    if (!was.is_usable) return;
    Array<Scalar, kOutputs> target, deviation;
    for (int i = 0; i < kOutputs; ++i) {
      target[i] = (taught.value[i] - was.value[i]) / was.scale[i];
      deviation[i] = was.deviation[i] / was.scale[i];
      if (!std::isfinite(target[i]) || !(deviation[i] > Scalar(0))) return;
    }
    for (int i = 0; i < kOutputs; ++i) {
      trust_[i].add(target[i] / deviation[i], was.predicted[i] / deviation[i], was.gate, T);
    }
    if (waiting_s_ < kLearnStep_s) return;
    regression_.learn(was.features, target, deviation, waiting_s_);
    waiting_s_ = 0;
  }

  // Would the last sample's correction have predicted this one's position?
  void hear_position(const Filtered& now, Scalar T) {
    const Kept& last = kept_[newest_];
    if (kept_count_ == 0 || !last.is_usable || !(now.innovation_sd_m > Scalar(0))) return;
    const Scalar added_m = (change(0, last) + change(1, last) * T * Scalar(0.5)) * T;
    positions_.add(now.standardised_innovation, last.gate * added_m / now.innovation_sd_m, T);
  }

  // The innovation, in standard deviations, that the last sample's correction has announced.
  Scalar announced(const Filtered& now, Scalar T) const {
    if (kept_count_ == 0 || !(now.innovation_sd_m > Scalar(0))) return 0;
    const auto& given = kept_[newest_].given;
    return (given[0] + given[1] * T * Scalar(0.5)) * T / now.innovation_sd_m;
  }

  // The predicted error of output `i`, limited.
  static Scalar change(int i, const Kept& kept) {
    const Scalar most = kMostCorrection * kept.deviation[i];
    return std::clamp(kept.predicted[i] * kept.scale[i], -most, most);
  }

  // 0 up to a surprise of `first`, 1 from twice that on.
  Scalar surprise_above(int first) const {
    const auto begin = static_cast<Scalar>(first);
    return std::clamp((surprise_ - begin) / begin, Scalar(0), Scalar(1));
  }

  static Scalar limited(Scalar ratio, double factor) {
    return static_cast<Scalar>(factor) * std::clamp(ratio, -kMostRatio, kMostRatio);
  }

  bool describe(const Filtered& now, const Taught& taught, Features& f) const {
    const Scalar sv = scale_[0], sa = scale_[1];
    const Scalar since_s = difference_s<Scalar>(now.time_ns, taught.time_ns);
    const Scalar v = now.value[0];
    const auto past = [&](TimeNs before_ms, double factor) {
      return limited(history_.at(now.time_ns, before_ms * 1'000'000) / sv, factor);
    };
    int n = 0;
    f[n++] = limited(v / sv, 1);
    f[n++] = limited((v - taught.value[0] - taught.value[1] * since_s) / sv, 3);
    f[n++] = limited((now.position_m - mean_position_m_) / position_scale_m_, 0.7);
    f[n++] = limited(innovations_[0], 0.3);
    f[n++] = limited(taught.value[1] / sa, 0.5);
    f[n++] = past(100, 0.7);
    f[n++] = past(167, 0.7);
    f[n++] = past(267, 0.5);
    for (const Scalar innovation : innovations_) f[n++] = limited(innovation, 0.3);
    for (const TimeNs before_ms : {400, 550, 700, 850}) f[n++] = past(before_ms, 0.7);
    for (const Scalar feature : f) {
      if (!std::isfinite(feature)) return false;
    }
    return true;
  }

  Corrected correct(const Filtered& now, const Taught* taught) {
    Corrected result;
    for (int i = 0; i < kOutputs; ++i) result.standard_deviation[i] = now.standard_deviation[i];
    Kept& kept = keep();
    kept = Kept();
    if (!has_taught_ || !describe(now, *taught, kept.features)) return result;
    const auto prediction = regression_.predict(kept.features);
    kept.gate =
        std::clamp((prediction.nearness - Scalar(0.15)) / Scalar(0.3), Scalar(0), Scalar(1));
    kept.is_usable = true;
    for (int i = 0; i < kOutputs; ++i) {
      kept.value[i] = now.value[i];
      kept.deviation[i] = now.standard_deviation[i];
      kept.scale[i] = scale_[i];
      kept.predicted[i] = prediction.value[i];
      if (!is_coloured_) correct(i, kept, result);
      usual_[i] += (kept.deviation[i] - usual_[i]) / (scale_count_ + Scalar(1));
    }
    return result;
  }

  // Output `i`.
  void correct(int i, Kept& kept, Corrected& result) const {
    const Scalar s = kept.deviation[i];
    const Scalar settled = std::clamp(Scalar(3) - s / usual_[i], Scalar(0), Scalar(1));
    const Scalar share = std::min(trust_[i].alpha(), positions_.beta()) * kept.gate * settled *
                         (Scalar(1) - surprise_above(4));
    if (!(share > Scalar(0))) return;
    const Scalar d = share * change(i, kept);
    const Scalar corrected = std::sqrt(s * s + surprise_above(2) * d * d);
    if (!std::isfinite(d) || !std::isfinite(corrected)) return;
    result.correction[i] = kept.given[i] = d;
    result.standard_deviation[i] = corrected;
    result.share[i] = share;
  }

  Regression regression_;
  Array<OutputTrust<Scalar>, kOutputs> trust_;
  PositionTrust<Scalar> positions_;
  InnovationMonitor<Scalar> monitor_;
  VelocityHistory<Scalar> history_;
  bool has_time_ = false, has_taught_ = false, is_coloured_ = false;
  bool has_scales_ = false;  // of an earlier recording
  TimeNs time_ns_ = 0;
  std::uint32_t watched_ = 0;
  Scalar waiting_s_ = 0;                          // since a sample was learned
  Scalar surprise_ = 0;                           // m
  Array<Scalar, kInnovations> innovations_ = {};  // the newest first
  Scalar scale_count_ = 0, mean_position_m_ = 0;
  Scalar position_square_ = Scalar(1e-8), position_scale_m_ = Scalar(1e-4);
  Array<Scalar, kOutputs> square_ = {Scalar(1e-6), Scalar(1e-2)};
  Array<Scalar, kOutputs> scale_ = {Scalar(1e-3), Scalar(1e-1)};
  Array<Scalar, kOutputs> usual_ = {};  // deviations
  int newest_ = 0, kept_count_ = 0;
  Array<Kept, kKept> kept_ = {};
};

}  // namespace condyle
