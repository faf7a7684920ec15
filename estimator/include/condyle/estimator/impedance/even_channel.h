// SPDX-License-Identifier: Apache-2.0
// One measured quantity for the regression: at even steps, with the noise that its own samples
// show.
//
//   T         the median of the first steps; even_grid.h brings what follows to it
//   s^2       mean of the squares of sixth differences (noise_difference.h)
//
// A step longer than 3.5 T, or than stated, ends a segment; within a segment, missing values are
// interpolated. Samples closer than the least step are averaged first, both times and values.
#pragma once

#include "condyle/estimator/impedance/even_grid.h"
#include "condyle/estimator/impedance/noise_difference.h"

namespace condyle {

/// Counts of the samples of a channel.
struct EvenChannelCounts {
  std::uint64_t not_in_order = 0;  ///< samples that were dropped
  std::uint64_t gaps = 0;          ///< ends of segments, by a gap or a clock set back
};

/// The samples of the present segment, as many as fit. Fixed size, no allocation.
template <class Scalar, std::size_t kCapacity>
class EvenChannel {
 public:
  /// Samples closer than `least_step_ns` are averaged; a step beyond `longest_gap_ns` ends a
  /// segment.
  EvenChannel(TimeNs least_step_ns, TimeNs longest_gap_ns)
      : least_step_ns_(least_step_ns), longest_gap_ns_(longest_gap_ns) {}

  /// Takes a sample. `before_gap()` is called before a segment is given up.
  template <class BeforeGap>
  void add(TimeNs time_ns, Scalar value, BeforeGap&& before_gap) {
    if (has_newest_) {
      TimeNs step_ns = 0;
      const bool has_overflow = __builtin_sub_overflow(time_ns, newest_ns_, &step_ns);
      const TimeNs gap_ns = longest_step_ns();
      if (has_overflow || step_ns > gap_ns || step_ns < -gap_ns) {
        flush_group();
        before_gap();
        ++counts_.gaps;
        interrupt();
      } else if (step_ns <= 0) {
        ++counts_.not_in_order;
        return;
      }
    }
    if (group_count_ > 0 && time_ns - group_ns_ >= least_step_ns_) flush_group();
    if (group_count_ == 0) {
      group_ns_ = time_ns;
      group_later_ns_ = 0;
      group_sum_ = 0;
    }
    newest_ns_ = time_ns;
    has_newest_ = true;
    group_later_ns_ += time_ns - group_ns_;
    group_sum_ += value;
    ++group_count_;
    // The first sample of a group that cannot grow is passed on at once.
    if (is_learned_ && step_ns_ >= 2 * least_step_ns_) flush_group();
  }

  /// Begins a new segment: the next samples are not consecutive with the previous ones.
  void interrupt() {
    group_count_ = 0;
    has_newest_ = false;
    first_count_ = is_learned_ ? first_count_ : 0;
    grid_.interrupt();
    difference_.interrupt();
    begin_ = end_;
    ++segment_;
  }

  /// True once T is known.
  bool is_learned() const { return is_learned_; }
  Scalar step_s() const { return static_cast<Scalar>(seconds(step_ns_)); }
  /// Number of segments, so that a reader notices the end of one.
  std::uint64_t segment() const { return segment_; }
  const EvenChannelCounts& counts() const { return counts_; }

  /// Range of the stored points: begin() to end() - 1, all of one segment.
  std::uint64_t begin() const { return end_ - begin_ > kCapacity ? end_ - kCapacity : begin_; }
  std::uint64_t end() const { return end_; }
  /// A point; `begin() <= index < end()`.
  TimeNs time_ns(std::uint64_t index) const { return times_ns_[place_of(index)]; }
  Scalar value(std::uint64_t index) const { return values_[place_of(index)]; }
  /// Half the time between its neighbours (s); `begin() < index < end() - 1`.
  Scalar width_s(std::uint64_t index) const {
    return difference_s<Scalar>(time_ns(index + 1), time_ns(index - 1)) / Scalar(2);
  }

  /// The noise from the samples' differences since the last call; each call starts again.
  NoiseSums<Scalar> take_noise() {
    const NoiseSums<Scalar> taken = noise_;
    noise_ = {};
    return taken;
  }
  const NoiseSums<Scalar>& noise() const { return noise_; }
  NoiseLagSums<Scalar> take_colour() {
    const NoiseLagSums<Scalar> taken = colour_;
    colour_.fill(Scalar(0));
    return taken;
  }

 private:
  static constexpr std::size_t kFirst = 17;  // samples that determine T
  static constexpr TimeNs kLongestFirstStep_ns = kNanosecondsPerSecond;

  TimeNs longest_step_ns() const {
    if (!is_learned_) return kLongestFirstStep_ns;
    const TimeNs steps_ns = step_ns_ * 7 / 2;
    return steps_ns < longest_gap_ns_ ? steps_ns : longest_gap_ns_;
  }

  void flush_group() {
    if (group_count_ == 0) return;
    const TimeNs time_ns = group_ns_ + group_later_ns_ / group_count_;
    const Scalar value = group_sum_ / static_cast<Scalar>(group_count_);
    group_count_ = 0;
    if (is_learned_) return give(time_ns, value);
    first_times_ns_[first_count_] = time_ns;
    values_[first_count_] = value;  // the ring is empty still
    if (++first_count_ == kFirst) learn();
  }

  void learn() {
    std::array<TimeNs, kFirst - 1> steps_ns;
    for (std::size_t k = 1; k < kFirst; ++k) {
      const TimeNs step_ns = first_times_ns_[k] - first_times_ns_[k - 1];
      std::size_t place = k - 1;  // sorted by insertion
      for (; place > 0 && steps_ns[place - 1] > step_ns; --place) {
        steps_ns[place] = steps_ns[place - 1];
      }
      steps_ns[place] = step_ns;
    }
    step_ns_ = steps_ns[(kFirst - 1) / 2];
    is_learned_ = true;
    grid_ = EvenGrid<Scalar>(step_ns_);
    difference_ = NoiseDifference<Scalar>(step_s());
    std::array<Scalar, kFirst> first;
    for (std::size_t k = 0; k < kFirst; ++k) first[k] = values_[k];
    for (std::size_t k = 0; k < kFirst; ++k) {
      if (k > 0 && first_times_ns_[k] - first_times_ns_[k - 1] > longest_step_ns()) {
        ++counts_.gaps;
        interrupt();
      }
      give(first_times_ns_[k], first[k]);
    }
  }

  static std::size_t place_of(std::uint64_t index) {
    return static_cast<std::size_t>(index % kCapacity);
  }

  void give(TimeNs time_ns, Scalar value) {
    difference_.add(time_ns, value, noise_, colour_);
    grid_.add(time_ns, value, [this](TimeNs point_ns, Scalar point) {
      times_ns_[place_of(end_)] = point_ns;
      values_[place_of(end_)] = point;
      ++end_;
    });
  }

  TimeNs least_step_ns_, longest_gap_ns_;
  TimeNs step_ns_ = 0;
  bool is_learned_ = false, has_newest_ = false;
  std::array<TimeNs, kFirst> first_times_ns_{};
  std::size_t first_count_ = 0;
  TimeNs newest_ns_ = 0, group_ns_ = 0, group_later_ns_ = 0;
  Scalar group_sum_ = 0;
  TimeNs group_count_ = 0;
  EvenGrid<Scalar> grid_{1};
  NoiseDifference<Scalar> difference_{Scalar(1)};
  NoiseSums<Scalar> noise_;
  NoiseLagSums<Scalar> colour_{};
  std::uint64_t begin_ = 0, end_ = 0, segment_ = 0;
  std::array<TimeNs, kCapacity> times_ns_{};
  std::array<Scalar, kCapacity> values_{};
  EvenChannelCounts counts_;
};

}  // namespace condyle
