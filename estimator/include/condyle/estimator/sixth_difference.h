// SPDX-License-Identifier: Apache-2.0
// The variance of white noise on a smooth signal, from the signal itself.
//
//   z_k, t_k   seven samples in a row and their times
//   T          the median step; scales the times, no more
//   d_k        prod over l != k of T / (t_k - t_l): the weights of the sixth divided difference
//
// Variance:    (sum d_k z_k)^2 / sum d_k^2. A polynomial of degree 5 adds nothing; at even steps
//              d_k are the binomials 1, -6, 15, -20, ... over 6!, and sum d_k^2 is 924 / 6!^2.
#pragma once

#include <array>

#include "condyle/estimator/sample.h"

namespace condyle {

/// Takes samples in order of time. Fixed size.
template <class Scalar>
class SixthDifference {
 public:
  /// Seven samples that span more than `longest_span_s` say nothing; `step_s` > 0 is T.
  SixthDifference(Scalar step_s, Scalar longest_span_s)
      : step_s_(step_s), longest_span_s_(longest_span_s) {}

  /// The variance that the last seven samples show, in the square of the unit of `value`; negative
  /// where there are not seven within the span, or two of them share an instant.
  Scalar add(TimeNs time_ns, Scalar value) {
    times_ns_[newest_] = time_ns;
    values_[newest_] = value;
    newest_ = (newest_ + 1) % kSamples;
    if (count_ < kSamples) ++count_;
    if (count_ < kSamples) return Scalar(-1);
    std::array<Scalar, kSamples> t;  // after the oldest, which is the next to be replaced
    for (std::size_t k = 0; k < kSamples; ++k) {
      t[k] = difference_s<Scalar>(times_ns_[k], times_ns_[newest_]);
      if (t[k] > longest_span_s_) return Scalar(-1);
    }
    Scalar sum = 0, weights2 = 0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      Scalar weight = 1;
      for (std::size_t l = 0; l < kSamples; ++l) {
        if (l == k) continue;
        const Scalar distance_s = t[k] - t[l];
        if (distance_s == Scalar(0)) return Scalar(-1);
        weight *= step_s_ / distance_s;
      }
      sum += weight * (values_[k] - values_[newest_]);
      weights2 += weight * weight;
    }
    return sum * sum / weights2;
  }

  /// The next sample is not in a row with those before.
  void interrupt() { count_ = 0; }

 private:
  static constexpr std::size_t kSamples = 7;
  Scalar step_s_, longest_span_s_;
  std::array<TimeNs, kSamples> times_ns_{};
  std::array<Scalar, kSamples> values_{};
  std::size_t newest_ = 0, count_ = 0;
};

}  // namespace condyle
