// SPDX-License-Identifier: Apache-2.0
// Chewing cycles while they happen: from one most closed instant to the next, given when they end.
//
//   z, v     height (m) and its rate (m/s), estimated; the jaw closes upward
//   s        speed (m/s): |v|, or that of a point in space
//   d        rise and fall that make a cycle: 2 mm, and 0.3 of the 90th percentile of the last 64
//            rises and falls of at least 2 mm
//   depth    below the top that counts as closed: 0.2 mm, 5 standard deviations of z, and 0.015 of
//            the cycle's height
//   closed instant   where v passes zero at the top of z; if the jaw is closed for 0.08 s or more,
//            the middle of that time. If it is closed for 0.5 s or more, a cycle ends with the
//            arrival and the next one begins with the departure: the zero of a cubic law through
//            the passages of depth and 4 depth
//   top      the highest z; a later sample takes its place if it is known twice as well and lies
//            within 5 standard deviations below: else the depth might exceed the next cycles
//   turn     where v passes zero at the bottom of z
//   sd of an instant   sd(v)/|a|, a the slope of v before it; of a middle 0.1 of the closed time;
//            of a departure or an arrival 8 ms, and a quarter of the way beyond the passage
// A sample whose z has a standard deviation of more than 0.5 mm is as if it were lost.
// A cycle is not taken, but given with the reason, if it has a gap of more than 0.1 s between
// samples, or lasts less than 0.25 s or more than 3 s. Movements lower than d are not cycles.
//
// These are the definitions of the analysis of a whole recording (condyle analyse), except for what
// is not known yet at the end of a cycle:
//   d        rests on the past, so movements before the first large cycle count as cycles from 2 mm
//            on
//   depth    at a top rests on the height before it; at the first top, on none
//   peaks    the largest estimated speed, not the top of its means; a speed's own noise raises it
//   end      is given when z has fallen by d, or 0.5 s after the jaw arrived at the top or left it
//            by less; if the jaw then closes further, the next cycle begins later
#pragma once

#include "condyle/estimator/motion/cycle_parts.h"
#include "condyle/estimator/provenance.h"

namespace condyle {

/// Why a cycle is not taken.
enum class CycleVerdict : std::uint8_t { taken, gap, too_short, too_long };

/// As a word, for files and messages; empty if it is taken.
constexpr const char* verdict_name(CycleVerdict verdict) {
  constexpr const char* names[] = {"", "gap", "too short", "too long"};
  return names[static_cast<int>(verdict)];
}

/// A cycle that has ended. Its quantities are `not_computed` if it is not taken.
template <class Scalar>
struct MotionCycle {
  CycleVerdict verdict = CycleVerdict::taken;
  TimeNs begin_ns = 0, turn_ns = 0, end_ns = 0;  ///< closed, most open, closed
  TimeNs known_ns = 0;                           ///< the sample at which its end was known
  TimeNs longest_gap_ns = 0;                     ///< between its samples
  bool begins_after_pause = false, ends_with_pause = false;
  Quantity<Scalar> duration_s, opening_time_s, closing_time_s;
  Quantity<Scalar> height_m;  ///< from the lowest to the highest
  Quantity<Scalar> opening_peak_speed_m_s, closing_peak_speed_m_s;
};

/// Finds cycles. Fixed size, no allocation; see above.
template <class Scalar>
class MotionCycles {
 public:
  using Sample = CycleSample<Scalar>;
  using Cycle = MotionCycle<Scalar>;

  /// The next sample; true if a cycle has ended, which is then in `ended`. A sample that is not
  /// later than the last one, not finite, or hardly known, is ignored.
  bool add(const Sample& sample, Cycle& ended);

  /// After the last sample: true if it ends a cycle, because the jaw stands still at the top.
  bool finish(Cycle& ended) {
    if (phase_ != Phase::closing || !has_begin_ || is_given_) return false;
    const bool is_closed =
        left_.has_passed || between_s<Scalar>(near_since_ns(), last_.time_ns) >= Scalar(kInstant_s);
    if (!is_closed) return false;
    give(kInstant_s, ended);
    return true;
  }

  /// Forgets everything, as after a restart of the clock.
  void reset() { *this = MotionCycles(); }

 private:
  using Instant = internal::CycleInstant<Scalar>;
  using Stretch = internal::CycleStretch<Scalar>;
  enum class Phase : std::uint8_t { unknown, opening, closing };

  static constexpr double kLeastHeight_m = 2e-3, kHeightShare = 0.3;
  static constexpr double kMostHeightSd_m = 0.5e-3;
  static constexpr double kLeastDepth_m = 0.2e-3, kDepthShare = 0.015, kDepthSds = 5;
  static constexpr double kInstant_s = 0.08, kPause_s = 0.5, kPauseSd_s = 8e-3, kMiddleSd = 0.1;
  static constexpr double kMean_s = 0.15, kLawSd = 0.25;
  static constexpr double kShortest_s = 0.25, kLongest_s = 3;
  static constexpr TimeNs kLongestGap_ns = 100'000'000;
  // How far above the true one the largest of many noisy values may lie, in standard deviations.
  static constexpr double kOfLargest = 3;
  static constexpr double kCubeRoot4 = 1.5874010519681994748;

  template <class T>
  static T between_s(TimeNs begin_ns, TimeNs end_ns) {
    return internal::between_s<T>(begin_ns, end_ns);
  }
  Scalar least_m() const {
    return std::max(Scalar(kLeastHeight_m), Scalar(kHeightShare) * travel_.percentile_90_m());
  }
  Scalar depth_m() const {
    const Scalar height_m = has_bottom_ ? top_.height_m - bottom_.height_m : Scalar(0);
    return std::max({Scalar(kLeastDepth_m), Scalar(kDepthSds) * top_.height_sd_m,
                     Scalar(kDepthShare) * height_m});
  }
  /// When the height came within the depth of the top.
  TimeNs near_since_ns() const { return flank_.passage_ns(top_.height_m - depth_m()); }
  /// The zero of the cubic law through the passages of the depth and of four times it.
  static Instant still_at(TimeNs near_ns, TimeNs far_ns) {
    const Scalar beyond_s = between_s<Scalar>(far_ns, near_ns) / Scalar(kCubeRoot4 - 1);
    const Scalar of_law_s = Scalar(kLawSd) * beyond_s;
    return {near_ns + static_cast<TimeNs>(beyond_s * Scalar(1e9)),
            std::sqrt(Scalar(kPauseSd_s * kPauseSd_s) + of_law_s * of_law_s)};
  }
  Instant arrival() const {
    const Scalar depth = depth_m();
    return still_at(flank_.passage_ns(closed_m_ - depth),
                    flank_.passage_ns(closed_m_ - Scalar(4) * depth));
  }
  TimeNs closed_until_ns() const { return left_.has_passed ? left_.time_ns : last_.time_ns; }

  /// The closed instant, unless the jaw pauses.
  Instant closed_instant() const {
    const TimeNs first_ns = near_since_ns(), last_ns = closed_until_ns();
    const Scalar closed_s = between_s<Scalar>(first_ns, last_ns);
    if (closed_s < Scalar(kInstant_s)) return at_top_.instant();
    return {first_ns + (last_ns - first_ns) / 2, Scalar(kMiddleSd) * closed_s};
  }
  Scalar closed_s() const { return between_s<Scalar>(near_since_ns(), closed_until_ns()); }

  void raise_top(const Sample& sample) {
    top_ = sample;
    at_top_.move_to(sample);
    left_ = departed_ = departed_far_ = {};
    if (!(closed_m_ > sample.height_m - depth_m())) closed_m_ = sample.height_m;
    going_.add(pending_);
    pending_ = {};
  }
  bool is_better_top(const Sample& sample) const {
    return sample.height_sd_m < top_.height_sd_m / 2 &&
           sample.height_m > top_.height_m - Scalar(kDepthSds) * top_.height_sd_m;
  }
  void lower_bottom(const Sample& sample) {
    bottom_ = sample;
    at_bottom_.move_to(sample);
    // Before the first turn the jaw may be closed, or closing, since the first sample.
    if (phase_ == Phase::unknown) return;
    has_bottom_ = true;
    flank_.clear();
    going_.add(pending_);
    pending_ = {};
  }
  /// The jaw opens from the top.
  void open(const Sample& sample) {
    const bool is_first = !has_top_before_;
    begins_after_pause_ = closed_s() >= Scalar(is_first ? kInstant_s : kPause_s);
    begin_ =
        begins_after_pause_ ? still_at(departed_.time_ns, departed_far_.time_ns) : closed_instant();
    if (begin_.time_ns < last_end_ns_ && has_top_before_) begin_.time_ns = last_end_ns_;
    // A jaw that opens from the first sample on may have been open already.
    has_begin_ = has_top_before_ || begins_after_pause_ ||
                 between_s<Scalar>(first_ns_, top_.time_ns) >= Scalar(kInstant_s);
    has_top_before_ = true;
    begin_top_ = top_;
    going_ = pending_;
    pending_ = {};
    phase_ = Phase::opening;
    lower_bottom(sample);
  }
  /// The jaw closes from the bottom.
  void close(const Sample& sample) {
    opening_ = going_;
    going_ = pending_;
    pending_ = {};
    turn_ = at_bottom_.instant();
    phase_ = Phase::closing;
    is_given_ = false;
    closed_m_ = sample.height_m;
    raise_top(sample);
  }
  void give(double pause_s, Cycle& ended);

  internal::TypicalTravel<Scalar> travel_{Scalar(kLeastHeight_m)};
  internal::RateSlope<Scalar> slope_;
  internal::RisingFlank<Scalar> flank_;
  internal::Standstill<Scalar> at_top_{Scalar(-1)}, at_bottom_{Scalar(1)};
  internal::FallingPassage<Scalar> left_;  ///< of the depth below the top
  Scalar closed_m_ = 0;                    ///< mean height while closed, over about kMean_s
  /// Of the depth and of four times it below that mean.
  internal::FallingPassage<Scalar> departed_, departed_far_;
  Phase phase_ = Phase::unknown;
  bool has_last_ = false, has_bottom_ = false;
  bool has_top_before_ = false;  ///< a top before the present one
  bool has_begin_ = false;       ///< a cycle has begun
  bool is_given_ = false;        ///< and has been given
  bool begins_after_pause_ = false;
  Sample last_, top_, bottom_, begin_top_;
  Instant begin_, turn_;
  TimeNs first_ns_ = 0, last_end_ns_ = 0;
  /// On the way down; of the present way, to its extreme and since then.
  Stretch opening_, going_, pending_;
};

template <class Scalar>
void MotionCycles<Scalar>::give(double pause_s, Cycle& ended) {
  ended = {};
  ended.begins_after_pause = begins_after_pause_;
  ended.ends_with_pause = closed_s() >= Scalar(pause_s);
  const Instant end = ended.ends_with_pause ? arrival() : closed_instant();
  ended.begin_ns = begin_.time_ns;
  ended.turn_ns = turn_.time_ns;
  ended.end_ns = last_end_ns_ = end.time_ns;
  ended.known_ns = last_.time_ns;
  ended.longest_gap_ns = std::max(opening_.gap_ns, going_.gap_ns);
  is_given_ = true;
  const Scalar duration_s = between_s<Scalar>(begin_.time_ns, end.time_ns);
  const Sample& highest = top_.height_m > begin_top_.height_m ? top_ : begin_top_;
  const Scalar height_m = highest.height_m - bottom_.height_m;
  if (ended.longest_gap_ns > kLongestGap_ns) {
    ended.verdict = CycleVerdict::gap;
  } else if (duration_s < Scalar(kShortest_s)) {
    ended.verdict = CycleVerdict::too_short;
  } else if (duration_s > Scalar(kLongest_s)) {
    ended.verdict = CycleVerdict::too_long;
  }
  if (ended.verdict != CycleVerdict::taken) return;
  const auto square = [](Scalar x) { return x * x; };
  const auto time_between = [&](const Instant& from, const Instant& to) {
    return quantity_of(between_s<Scalar>(from.time_ns, to.time_ns),
                       square(from.sd_s) + square(to.sd_s), Provenance::measured);
  };
  ended.duration_s = time_between(begin_, end);
  ended.opening_time_s = time_between(begin_, turn_);
  ended.closing_time_s = time_between(turn_, end);
  const Scalar of_largest = square(Scalar(kOfLargest));
  ended.height_m = quantity_of(
      height_m, of_largest * (square(highest.height_sd_m) + square(bottom_.height_sd_m)),
      Provenance::measured);
  const auto peak = [&](const Stretch& stretch) {
    return quantity_of(stretch.speed_m_s.value, of_largest * square(stretch.speed_m_s.sd),
                       Provenance::measured);
  };
  ended.opening_peak_speed_m_s = peak(opening_);
  ended.closing_peak_speed_m_s = peak(going_);
}

template <class Scalar>
bool MotionCycles<Scalar>::add(const Sample& sample, Cycle& ended) {
  const Scalar sum = sample.height_m + sample.height_sd_m + sample.rate_m_s + sample.rate_sd_m_s +
                     sample.speed_m_s + sample.speed_sd_m_s;
  if (!std::isfinite(sum) || (has_last_ && sample.time_ns <= last_.time_ns)) return false;
  if (sample.height_sd_m > Scalar(kMostHeightSd_m)) return false;
  if (!has_last_) {
    has_last_ = true;
    last_ = sample;
    first_ns_ = sample.time_ns;
    closed_m_ = sample.height_m;
    raise_top(sample);
    lower_bottom(sample);
  }
  const Sample before = last_;
  last_ = sample;
  travel_.add(sample.height_m);
  slope_.add(before);
  const Scalar slope_m_s2 = slope_.before(sample);
  pending_.speed_m_s.raise(sample.speed_m_s, sample.speed_sd_m_s);
  pending_.gap_ns = std::max(pending_.gap_ns, sample.time_ns - before.time_ns);
  if (phase_ != Phase::opening) {
    if (is_better_top(sample)) {
      closed_m_ = sample.height_m;
      raise_top(sample);
    } else if (sample.height_m > top_.height_m) {
      raise_top(sample);
    }
  }
  if (phase_ != Phase::closing && sample.height_m < bottom_.height_m) lower_bottom(sample);
  at_top_.add(before, sample, slope_m_s2);
  at_bottom_.add(before, sample, slope_m_s2);
  const Scalar depth = depth_m();
  flank_.add(sample, std::max(Scalar(kLeastDepth_m / 8), depth / Scalar(12)));
  if (phase_ == Phase::opening) {
    if (sample.height_m - bottom_.height_m >= least_m()) close(sample);
    return false;
  }
  left_.add(before, sample, top_.height_m - depth);
  if (!left_.has_passed) {
    const Scalar step_s = between_s<Scalar>(before.time_ns, sample.time_ns);
    closed_m_ += (sample.height_m - closed_m_) * std::min(step_s / Scalar(kMean_s), Scalar(1));
  }
  departed_.add(before, sample, closed_m_ - depth);
  departed_far_.add(before, sample, closed_m_ - Scalar(4) * depth);
  const bool is_pause = !left_.has_passed && closed_s() >= Scalar(kPause_s);
  if (is_pause) pending_.gap_ns = 0;
  const Scalar fall_m = top_.height_m - sample.height_m;
  const bool opens = fall_m >= std::max(least_m(), Scalar(4) * depth) && departed_far_.has_passed;
  const bool is_quiet =
      is_pause ||
      (left_.has_passed && between_s<Scalar>(left_.time_ns, sample.time_ns) >= Scalar(kPause_s));
  const bool ends = phase_ == Phase::closing && has_begin_ && !is_given_ && (opens || is_quiet);
  if (ends) give(kPause_s, ended);
  if (opens) {
    open(sample);
  } else if (phase_ == Phase::unknown && sample.height_m - bottom_.height_m >= least_m()) {
    has_bottom_ = true;
    close(sample);
    has_begin_ = false;
  }
  return ends;
}

}  // namespace condyle
