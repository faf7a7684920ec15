// SPDX-License-Identifier: Apache-2.0
// Detects a change of the effective damping of a chewing point. It is not a diagnosis: joint,
// muscle, tissue, food, and a drive that misses another force or has another delay look alike. If
// the drive is not known in full, a change is not known either.
//
//   x, s      a cycle's damping and its standard deviation (Ns/m), cycle_damping.h
//   b, w      mean of all cycles before, weighted by 1 / s^2, and its weight sum 1 / s^2
//   e         residual (x - b) / (s^2 + 1/w)^1/2
//   g, n      spread: root mean square of the n residuals before; about 1 if s is right
//   t, y      e / g; the same, turned into a standard normal variable
//   D, d      smallest change that matters (Ns/m); the same in standard deviations of x - b
//   U, V      statistics for a change up, down
//   N, h      cycles between two false alarms; threshold
//
// Residual:    e of independent cycles are independent whatever b is (recursive residuals; Brown,
//              Durbin, Evans, J. R. Stat. Soc. B 37 (1975) 149), so that what is not known of the
//              baseline needs no guess: it widens e (self-starting; Hawkins, The Statistician 36
//              (1987) 299)
// Scale:       t has Student's distribution with n degrees of freedom, so that s need be right up
//              to a factor only, be it by noises set wrongly or by cycles that differ;
//              y = sign(t) (8n + 1)/(8n + 3) (n log(1 + t^2/n))^1/2 (Wallace, Ann. Math. Statist.
//              30 (1959) 1124), cut at 4: no single cycle makes an alarm by itself, nor does it
//              blind the detector, as e is cut at 4 g in g
// CUSUM:       U <- max(0, U + d y - d^2/2), V <- max(0, V - d y - d^2/2), d = D / (g (s^2 +
//              1/w)^1/2), at most 2 (Page, Biometrika 41 (1954) 100)
// Threshold:   (e^a - a - 1) / (d^2/2) = 2 N, h = a - 1.166 d + 0.012 d^2, with the mean d^2 of the
//              last 50 cycles (Siegmund, Sequential Analysis, 1985, for each of two sides; the term
//              in d^2 takes his exp(-0.583 d) to within 0.5 % of the overshoot's exact series
//              2 d^-2 exp(-2 sum Phi(-d n^1/2 / 2) / n) at d = 1.5 and 2)
// Alarm:       U or V above h. Of the last 32 cycles the change is put before the one for which
//              (after - before)^2 / (1/w_after + 1/w_before) is largest, the two weighted means
//              (most likely, both unknown; Hinkley, Biometrika 57 (1970) 1); `after` then leaves
//              that cycle out, as the change may have come in it, if it is not the only one
//
// Lorden's bound (Ann. Math. Statist. 42 (1971) 1897): no rule with N detects a change of D within
// fewer than log N / (D^2 / (2 s^2)) cycles on average, to first order.
//
// b follows a slow drift, so that it remains undetected: a change must occur within some tens of
// cycles, after at least baseline_cycles. A change during these first cycles is not detected
// either.
#pragma once

#include <cstdint>

#include "condyle/estimator/changes/change_parameters.h"
#include "condyle/estimator/math/elementary.h"

namespace condyle {

/// State of the detector.
enum class ChangeState : std::uint8_t {
  learning,   ///< too few cycles yet
  watching,   ///< nothing has been detected
  increased,  ///< damping has increased; stays until reset
  decreased,  ///< damping has decreased; stays until reset
};

/// Name of a state in files and summaries.
constexpr const char* change_state_name(ChangeState state) {
  constexpr const char* names[] = {"learning", "watching", "increased", "decreased"};
  return names[static_cast<int>(state)];
}

/// A mean and the sum of its weights, each 1 / variance.
template <class Scalar>
struct WeightedMean {
  Scalar mean = 0, weight = 0;
  /// Adds `x` with the weight `of_x` > 0.
  void add(Scalar x, Scalar of_x) {
    weight += of_x;
    mean += of_x / weight * (x - mean);
  }
};

/// A detected change, in Ns/m.
template <class Scalar>
struct DampingChange {
  Scalar before_Ns_m = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar before_sd = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar after_Ns_m = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar after_sd = std::numeric_limits<Scalar>::quiet_NaN();
  std::int64_t first_after = 0;  ///< first cycle after the estimated change; counted from 0
  std::int64_t alarm = 0;        ///< cycle that raised the alarm
};

/// Judges cycles one by one. Fixed size, no allocation; see above.
template <class Scalar>
class ChangeDetector {
 public:
  /// `parameters` must be valid.
  explicit ChangeDetector(const ChangeParameters& parameters) : parameters_(parameters) {}

  /// The next counted cycle: its damping `x` and standard deviation `s` (Ns/m), both finite, s > 0.
  /// After an alarm, cycles are ignored until reset.
  ChangeState add(Scalar x, Scalar s) {
    if (is_alarm()) return state_;
    using std::sqrt;
    const Scalar weight = Scalar(1) / (s * s);
    if (cycles_ > 0) {
      const Scalar sd = sqrt(s * s + Scalar(1) / all_.weight);
      const Scalar e = (x - all_.mean) / sd;
      if (Scalar(cycles_) >= Scalar(parameters_.baseline_cycles)) judge(e, sd);
      const Scalar most = square(kMostDeviation * spread());
      const bool is_wild = residuals_ >= Scalar(10) && e * e > most;
      residuals_ += Scalar(1);
      square_ += ((is_wild ? most : e * e) - square_) / residuals_;
    }
    all_.add(x, weight);
    kept_[cycles_ % kKept] = {x, weight};
    ++cycles_;
    if (is_alarm()) locate_change();
    return state_;
  }

  /// Forgets everything and learns a new baseline.
  void reset() { *this = ChangeDetector(parameters_); }

  ChangeState state() const { return state_; }
  bool is_alarm() const {
    return state_ == ChangeState::increased || state_ == ChangeState::decreased;
  }
  /// The change; NaN without an alarm.
  const DampingChange<Scalar>& change() const { return change_; }
  /// Cycles added since the start or reset.
  std::int64_t cycles() const { return cycles_; }
  /// Root mean square of the residuals, at least 0.5: scatter of the cycles in units of their own
  /// standard deviations. Far from 1, the stated noises are wrong or damping varies by itself.
  Scalar spread() const {
    using std::sqrt;
    return square_ > Scalar(0.25) ? sqrt(square_) : Scalar(0.5);
  }
  /// The larger statistic, and the threshold (0 until a cycle is judged).
  Scalar statistic() const { return up_ > down_ ? up_ : down_; }
  Scalar threshold() const { return threshold_; }
  /// U and V.
  Scalar statistic_up() const { return up_; }
  Scalar statistic_down() const { return down_; }

 private:
  struct Cycle {
    Scalar friction_Ns_m = 0, weight = 0;
  };
  static constexpr int kKept = 32;
  static constexpr Scalar kMostDeviation = 4;

  static Scalar square(Scalar value) { return value * value; }

  void judge(Scalar e, Scalar sd) {
    constexpr Scalar kLargest = 2, kMemory = 50;
    const Scalar expected = Scalar(parameters_.change_Ns_m) / (spread() * sd);
    const Scalar d = expected < kLargest ? expected : kLargest;
    judged_ += judged_ < kMemory ? Scalar(1) : Scalar(0);
    d_square_ += (d * d - d_square_) / judged_;
    threshold_ = threshold_for(d_square_);
    state_ = ChangeState::watching;
    const Scalar y = normal_of(e / spread());
    const auto follow = [&](Scalar& statistic, Scalar towards, ChangeState alarm) {
      const Scalar next = statistic + towards * d * y - d * d / Scalar(2);
      statistic = next > Scalar(0) ? next : Scalar(0);
      if (statistic > threshold_) state_ = alarm;
    };
    state_ = ChangeState::watching;
    follow(up_, Scalar(1), ChangeState::increased);
    follow(down_, Scalar(-1), ChangeState::decreased);
  }

  // The last cycle raised the alarm.
  void locate_change() {
    using std::sqrt;
    const Scalar towards = state_ == ChangeState::increased ? Scalar(1) : Scalar(-1);
    WeightedMean<Scalar> before = all_, after;
    Scalar best = 0;
    for (int back = 0; back < kKept && back < cycles_ - 1; ++back) {
      const std::int64_t number = cycles_ - 1 - back;
      const Cycle& cycle = kept_[number % kKept];
      WeightedMean<Scalar> without = after;
      after.add(cycle.friction_Ns_m, cycle.weight);
      before.add(cycle.friction_Ns_m, -cycle.weight);
      const Scalar step = towards * (after.mean - before.mean);
      const Scalar gain = step * step / (Scalar(1) / after.weight + Scalar(1) / before.weight);
      if (!(step > Scalar(0) && gain > best)) continue;
      best = gain;
      if (back == 0) without = after;
      change_ = {before.mean,  spread() / sqrt(before.weight),
                 without.mean, spread() / sqrt(without.weight),
                 number,       cycles_ - 1};
    }
  }

  // The standard normal variable with the same probability as `t` of Student's distribution.
  Scalar normal_of(Scalar t) const {
    using std::sqrt;
    const Scalar n = residuals_;
    const Scalar size = (Scalar(8) * n + Scalar(1)) / (Scalar(8) * n + Scalar(3)) *
                        sqrt(n * elementary::log(Scalar(1) + t * t / n));
    const Scalar cut = size < kMostDeviation ? size : kMostDeviation;
    return t < Scalar(0) ? -cut : cut;
  }

  Scalar threshold_for(Scalar d_square) const {
    using std::sqrt;
    constexpr int kRounds = 6;  // each reduces the error of a about tenfold
    constexpr Scalar kOvershoot = Scalar(1.166), kOfSquare = Scalar(0.012);
    const Scalar e_to_a = Scalar(parameters_.false_alarm_cycles) * d_square + Scalar(1);
    Scalar a = elementary::log(e_to_a + Scalar(1));
    for (int i = 0; i < kRounds; ++i) a = elementary::log(e_to_a + a);
    const Scalar h = a - kOvershoot * sqrt(d_square) + kOfSquare * d_square;
    return h > Scalar(0) ? h : Scalar(0);
  }

  ChangeParameters parameters_;
  ChangeState state_ = ChangeState::learning;
  std::int64_t cycles_ = 0;
  WeightedMean<Scalar> all_;
  Scalar residuals_ = 0, square_ = 0;  ///< their number and mean square
  Scalar judged_ = 0, d_square_ = 0, threshold_ = 0;
  Scalar up_ = 0, down_ = 0;  ///< the statistics
  Array<Cycle, kKept> kept_;  ///< the last ones, by number
  DampingChange<Scalar> change_;
};

}  // namespace condyle
