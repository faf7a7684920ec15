// SPDX-License-Identifier: Apache-2.0
// White noise on a smooth signal, from the signal itself.
//
//   n          the order
//   z_k, t_k   n + 1 samples and their times
//   T          the median step between them; scales the times, no more
//   d_k        prod over l != k of T / (t_k - t_l), over the root of the sum of their squares: the
//              weights of the n-th divided difference, normalised
//
// Difference:  D = sum d_k z_k. A polynomial of degree n - 1 adds nothing; white noise makes D^2
//              its variance in the mean. At even steps the d_k are the binomials with alternating
//              sign: at n = 6 1, -6, 15, -20, ... over the root of 924.
// Neighbours:  rho = sum d_k d'_k over the samples that D shares with D' before it: the correlation
//              of both where the noise is white
#pragma once

#include <array>

#include "condyle/estimator/sample.h"

namespace condyle {

/// Takes samples in order of time. Fixed size.
template <class Scalar, std::size_t kOrder>
class NoiseDifference {
 public:
  /// `step_s` > 0 is T. Samples that span more than 17 / 12 n T say nothing.
  explicit NoiseDifference(Scalar step_s)
      : step_s_(step_s), longest_span_s_(Scalar(kOrder) * step_s * Scalar(17) / Scalar(12)) {}

  /// Takes a sample. False where there are not n + 1 within the span, or two of them share an
  /// instant; what the other functions give is then of no use.
  bool add(TimeNs time_ns, Scalar value) {
    has_before_ = is_known_;
    is_known_ = false;
    times_ns_[newest_] = time_ns;
    values_[newest_] = value;
    newest_ = (newest_ + 1) % kSamples;
    if (count_ < kSamples) ++count_;
    if (count_ < kSamples) return false;
    const std::size_t oldest = newest_;
    std::array<Scalar, kSamples> t;  // in steps after the oldest
    for (std::size_t k = 0; k < kSamples; ++k) {
      const Scalar after_s = difference_s<Scalar>(time_of(oldest, k), times_ns_[oldest]);
      if (after_s > longest_span_s_) return false;
      t[k] = after_s / step_s_;
    }
    using std::sqrt;
    const std::array<Scalar, kSamples> before = weights_;
    weights_.fill(Scalar(1));
    for (std::size_t k = 1; k < kSamples; ++k) {
      for (std::size_t l = 0; l < k; ++l) {
        const Scalar apart = t[k] - t[l];
        weights_[k] *= apart;
        weights_[l] *= -apart;
      }
    }
    Scalar sum = 0, weights2 = 0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      if (weights_[k] == Scalar(0)) return false;
      weights_[k] = Scalar(1) / weights_[k];
      sum += weights_[k] * (values_[(oldest + k) % kSamples] - values_[oldest]);
      weights2 += weights_[k] * weights_[k];
    }
    const Scalar norm = Scalar(1) / sqrt(weights2);
    before_ = value_;
    value_ = sum * norm;
    correlation_ = 0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      weights_[k] *= norm;
      if (k > 0) correlation_ += weights_[k - 1] * before[k];
    }
    is_known_ = true;
    return true;
  }

  /// D (unit of the values).
  Scalar value() const { return value_; }
  /// True where the sample before gave a difference too.
  bool has_before() const { return has_before_; }
  /// D' - where `has_before` - and rho.
  Scalar before() const { return before_; }
  Scalar correlation() const { return correlation_; }

  /// The next sample is not in a row with those before.
  void interrupt() {
    count_ = 0;
    is_known_ = false;
  }

 private:
  static constexpr std::size_t kSamples = kOrder + 1;
  TimeNs time_of(std::size_t oldest, std::size_t k) const {
    return times_ns_[(oldest + k) % kSamples];
  }

  Scalar step_s_, longest_span_s_;
  std::array<TimeNs, kSamples> times_ns_{};
  std::array<Scalar, kSamples> values_{}, weights_{};
  std::size_t newest_ = 0, count_ = 0;
  Scalar value_ = 0, before_ = 0, correlation_ = 0;
  bool is_known_ = false, has_before_ = false;
};

/// Sums of what the differences of a recording's samples show.
template <class Scalar>
struct NoiseSums {
  Scalar variance = 0;    ///< of D^2 at n = 6
  Scalar count = 0;       ///< how many
  Scalar neighbours = 0;  ///< of D D' - rho (D^2 + D'^2) / 2: about 0 where the noise is white
  Scalar apart = 0;       ///< of D_2^2 - D^2, D_2 of every other sample, n = 8: likewise

  template <class Other>
  void add(const NoiseSums<Other>& other) {
    variance += Scalar(other.variance);
    count += Scalar(other.count);
    neighbours += Scalar(other.neighbours);
    apart += Scalar(other.apart);
  }
};

/// Fills them, sample by sample. Fixed size.
template <class Scalar>
class NoiseObserver {
 public:
  explicit NoiseObserver(Scalar step_s)
      : each_(step_s), others_{Every(Scalar(2) * step_s), Every(Scalar(2) * step_s)} {}

  void add(TimeNs time_ns, Scalar value, NoiseSums<Scalar>& sums) {
    Every& other = others_[turn_];
    turn_ = 1 - turn_;
    const bool has_other = other.add(time_ns, value);
    if (!each_.add(time_ns, value)) return;
    const Scalar D = each_.value(), D2 = D * D;
    sums.variance += D2;
    sums.count += Scalar(1);
    if (each_.has_before()) {
      const Scalar before = each_.before();
      sums.neighbours += D * before - each_.correlation() * (D2 + before * before) / Scalar(2);
    }
    if (has_other) sums.apart += other.value() * other.value() - D2;
  }

  /// The next sample is not in a row with those before.
  void interrupt() {
    each_.interrupt();
    for (Every& other : others_) other.interrupt();
  }

 private:
  using Every = NoiseDifference<Scalar, 8>;
  NoiseDifference<Scalar, 6> each_;
  std::array<Every, 2> others_;
  std::size_t turn_ = 0;
};

}  // namespace condyle
