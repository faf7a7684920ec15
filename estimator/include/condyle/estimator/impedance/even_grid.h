// SPDX-License-Identifier: Apache-2.0
// Resamples irregular samples at even steps.
//
//   T         step of the grid
//   t, z      times and values of the last six samples
//
// A sample within T / 50 of the next grid point becomes that point, and the grid continues from it,
// so that samples at even steps pass unchanged. Any other grid point is the polynomial of degree
// five through the six samples around it (Lagrange), three before and three after if the segment
// has that many.
#pragma once

#include <array>

#include "condyle/estimator/sample.h"

namespace condyle {

/// One segment of samples. Fixed size.
template <class Scalar>
class EvenGrid {
 public:
  /// `step_ns` > 0 is T.
  explicit EvenGrid(TimeNs step_ns) : step_ns_(step_ns) {}

  TimeNs step_ns() const { return step_ns_; }

  /// Takes a sample after the last one, and passes each grid point that is now known to
  /// `sink(time_ns, value)`. A sample within T / 5 of the previous one is dropped: a polynomial
  /// through both would magnify their noise.
  template <class Sink>
  void add(TimeNs time_ns, Scalar value, Sink&& sink) {
    if (count_ == 0) next_ns_ = time_ns;
    if (count_ > 0 && time_ns - times_ns_[count_ - 1] < step_ns_ / 5) return;
    if (count_ == kSamples) {
      for (std::size_t k = 1; k < kSamples; ++k) {
        times_ns_[k - 1] = times_ns_[k];
        values_[k - 1] = values_[k];
      }
      --count_;
    }
    times_ns_[count_] = time_ns;
    values_[count_] = value;
    ++count_;
    while (give_next(sink)) continue;
  }

  /// Begins a new segment.
  void interrupt() { count_ = 0; }

 private:
  static constexpr std::size_t kSamples = 6;

  // Passes on the next grid point if it is known; else returns false.
  template <class Sink>
  bool give_next(Sink&& sink) {
    for (std::size_t k = count_; k-- > 0;) {
      const TimeNs distance_ns = times_ns_[k] - next_ns_;
      if (distance_ns > step_ns_ / 50 || -distance_ns > step_ns_ / 50) continue;
      sink(times_ns_[k], values_[k]);
      step_from(times_ns_[k]);
      return true;
    }
    if (count_ < kSamples || next_ns_ > times_ns_[kSamples / 2]) return false;
    sink(next_ns_, interpolated());
    step_from(next_ns_);
    return true;
  }

  // The grid ends at the limit of TimeNs.
  void step_from(TimeNs time_ns) {
    if (__builtin_add_overflow(time_ns, step_ns_, &next_ns_)) interrupt();
  }

  Scalar interpolated() const {
    std::array<Scalar, kSamples> t;  // from the grid point
    for (std::size_t k = 0; k < kSamples; ++k) {
      t[k] = static_cast<Scalar>(times_ns_[k] - next_ns_) / static_cast<Scalar>(step_ns_);
    }
    Scalar rise = 0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      Scalar weight = 1;
      for (std::size_t l = 0; l < kSamples; ++l) {
        if (l != k) weight *= -t[l] / (t[k] - t[l]);
      }
      rise += weight * (values_[k] - values_[0]);
    }
    return values_[0] + rise;
  }

  TimeNs step_ns_, next_ns_ = 0;
  std::array<TimeNs, kSamples> times_ns_{};
  std::array<Scalar, kSamples> values_{};
  std::size_t count_ = 0;
};

}  // namespace condyle
