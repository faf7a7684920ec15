// SPDX-License-Identifier: Apache-2.0
// A drive or an EMG on its own times beside the positions: its present interval, and the positions
// that wait for the end of it.
#pragma once

#include <array>

#include "condyle/estimator/sample.h"

namespace condyle {

/// How a sample follows the one before.
enum class SampleOrder {
  first,         ///< none came before
  next,          ///< within the longest gap
  after_gap,     ///< beyond it, either way: a new beginning
  not_in_order,  ///< not later: left out
};

/// The interval between two neighbouring samples of a channel, on the clock of the positions.
class SampledInterval {
 public:
  /// `shift_ns` is added to the channel's times. A negative gap counts as 0.
  SampledInterval(TimeNs shift_ns, TimeNs longest_gap_ns)
      : shift_ns_(shift_ns), longest_gap_ns_(longest_gap_ns > 0 ? longest_gap_ns : 0) {}

  /// A sample stamped `time_ns`. After `next` the interval ends with it; after `first` and
  /// `after_gap` it begins and ends there; after `not_in_order` it is as before.
  SampleOrder add(TimeNs time_ns) {
    TimeNs at_ns = 0, step_ns = 0;
    const bool has_overflow = __builtin_add_overflow(time_ns, shift_ns_, &at_ns) ||
                              __builtin_sub_overflow(at_ns, end_ns_, &step_ns);
    SampleOrder order = SampleOrder::first;
    if (has_sample_) {
      const bool is_gap = has_overflow || step_ns > longest_gap_ns_ || step_ns < -longest_gap_ns_;
      order = is_gap ? SampleOrder::after_gap : SampleOrder::next;
      if (!is_gap && step_ns <= 0) return SampleOrder::not_in_order;
    }
    begin_ns_ = order == SampleOrder::next ? end_ns_ : at_ns;
    end_ns_ = at_ns;
    has_sample_ = true;
    return order;
  }

  /// The next sample is the first.
  void forget() { has_sample_ = false; }
  /// From now on.
  void set_shift(TimeNs shift_ns) { shift_ns_ = shift_ns; }

  bool has_sample() const { return has_sample_; }
  TimeNs begin_ns() const { return begin_ns_; }
  TimeNs end_ns() const { return end_ns_; }
  TimeNs shift_ns() const { return shift_ns_; }
  /// The interval's length (s).
  template <class Scalar>
  Scalar length_s() const {
    return static_cast<Scalar>(seconds(end_ns_ - begin_ns_));
  }
  /// Share of the interval, 0 to 1, that has passed at `time_ns`; 1 if it has no length.
  template <class Scalar>
  Scalar share(TimeNs time_ns) const {
    if (begin_ns_ == end_ns_) return Scalar(1);
    return static_cast<Scalar>(seconds(time_ns - begin_ns_)) / length_s<Scalar>();
  }

 private:
  TimeNs shift_ns_, longest_gap_ns_;
  TimeNs begin_ns_ = 0, end_ns_ = 0;
  bool has_sample_ = false;
};

/// A position (m) with the standard deviation of its noise (m).
template <class Scalar>
struct WaitingPosition {
  TimeNs time_ns = 0;
  Scalar position_m = 0, sd_m = 0;
};

/// Positions that wait for a sample after them, in the order of their times.
template <class Scalar>
class WaitingPositions {
 public:
  /// Enough for a channel of 25 Hz beside positions of 500 Hz, and some more.
  static constexpr std::size_t kMost = 64;

  bool is_full() const { return count_ == kMost; }
  bool is_empty() const { return count_ == 0; }
  /// The earliest; there must be one.
  const WaitingPosition<Scalar>& first() const { return positions_[0]; }
  /// Must not be full.
  void add(const WaitingPosition<Scalar>& position) { positions_[count_++] = position; }
  /// Gives `take(position)` those up to `end_ns` and removes them.
  template <class Take>
  void take_until(TimeNs end_ns, Take&& take) {
    std::size_t taken = 0;
    while (taken < count_ && positions_[taken].time_ns <= end_ns) take(positions_[taken++]);
    for (std::size_t i = taken; i < count_; ++i) positions_[i - taken] = positions_[i];
    count_ -= taken;
  }

 private:
  std::array<WaitingPosition<Scalar>, kMost> positions_{};
  std::size_t count_ = 0;
};

}  // namespace condyle
