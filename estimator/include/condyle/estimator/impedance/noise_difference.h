// SPDX-License-Identifier: Apache-2.0
// Estimates the white noise on a smooth signal from the signal itself, and checks that it is white.
//
//   z_k, t_k   seven samples in a row and their times
//   T          the median step; scales the times, no more
//   d_k        prod over l != k of T / (t_k - t_l), over the root of the sum of their squares: the
//              weights of the sixth divided difference, normalised
//
// Difference:  D = sum d_k z_k. A polynomial of degree 5 adds nothing; white noise makes D^2 its
//              variance on average. At even steps the d_k are 1, -6, 15, -20, ... over the root
//              of 924.
// Colour:      D_l is D of l samples before, rho_l = sum d_k d_l,k over the samples they share,
//              which is their correlation if the noise is white. Then the mean of
//              D D_l - rho_l (D^2 + D_l^2) / 2 is 0 at each lag l; a mean of n samples makes it
//              about -D^2 / 2 at l = n.
#pragma once

#include <array>

#include "condyle/estimator/sample.h"

namespace condyle {

/// Sums over the differences of a recording's samples.
template <class Scalar>
struct NoiseSums {
  Scalar variance = 0;  ///< of D^2
  Scalar count = 0;     ///< number of differences

  template <class Other>
  void add(const NoiseSums<Other>& other) {
    variance += Scalar(other.variance);
    count += Scalar(other.count);
  }
};

/// Sums, at each lag from 1, whose mean is about 0 for white noise; see above.
inline constexpr std::size_t kNoiseLags = 16;
template <class Scalar>
using NoiseLagSums = std::array<Scalar, kNoiseLags>;

/// Takes samples in order of time. Fixed size.
template <class Scalar>
class NoiseDifference {
 public:
  /// `step_s` > 0 is T. Seven samples that span more than 8.5 T are skipped.
  explicit NoiseDifference(Scalar step_s)
      : step_s_(step_s), longest_span_s_(Scalar(8.5) * step_s) {}

  /// Takes a sample and adds its differences to the sums. Adds nothing if there are not seven
  /// samples within the span, or if two of them share an instant.
  void add(TimeNs time_ns, Scalar value, NoiseSums<Scalar>& sums, NoiseLagSums<Scalar>& colour) {
    times_ns_[newest_] = time_ns;
    values_[newest_] = value;
    newest_ = (newest_ + 1) % kSamples;
    if (count_ < kSamples) ++count_;
    Difference now;
    if (count_ < kSamples || !make(now)) {
      known_ = 0;
      return;
    }
    sums.variance += now.D * now.D;
    sums.count += Scalar(1);
    for (std::size_t lag = 1; lag <= known_; ++lag) {
      const Difference& before = past_[(next_ + kNoiseLags - lag) % kNoiseLags];
      Scalar rho = 0;
      for (std::size_t k = lag; k < kSamples; ++k) rho += now.d[k - lag] * before.d[k];
      colour[lag - 1] += now.D * before.D - rho * (now.D * now.D + before.D * before.D) / Scalar(2);
    }
    past_[next_] = now;
    next_ = (next_ + 1) % kNoiseLags;
    if (known_ < kNoiseLags) ++known_;
  }

  /// The next sample is not consecutive with the previous ones.
  void interrupt() { count_ = known_ = 0; }

 private:
  static constexpr std::size_t kSamples = 7;
  struct Difference {
    Scalar D = 0;
    std::array<Scalar, kSamples> d{};
  };

  bool make(Difference& now) const {
    std::array<Scalar, kSamples> t;  // in steps after the oldest, which is the next to be replaced
    for (std::size_t k = 0; k < kSamples; ++k) {
      const Scalar after_s =
          difference_s<Scalar>(times_ns_[(newest_ + k) % kSamples], times_ns_[newest_]);
      if (after_s > longest_span_s_) return false;
      t[k] = after_s / step_s_;
    }
    now.d.fill(Scalar(1));
    for (std::size_t k = 1; k < kSamples; ++k) {
      for (std::size_t l = 0; l < k; ++l) {
        const Scalar apart = t[k] - t[l];
        now.d[k] *= apart;
        now.d[l] *= -apart;
      }
    }
    Scalar squares = 0;
    for (Scalar& d : now.d) {
      if (d == Scalar(0)) return false;
      d = Scalar(1) / d;
      squares += d * d;
    }
    using std::sqrt;
    const Scalar norm = Scalar(1) / sqrt(squares);
    for (std::size_t k = 0; k < kSamples; ++k) {
      now.d[k] *= norm;
      now.D += now.d[k] * (values_[(newest_ + k) % kSamples] - values_[newest_]);
    }
    return true;
  }

  Scalar step_s_, longest_span_s_;
  std::array<TimeNs, kSamples> times_ns_{};
  std::array<Scalar, kSamples> values_{};
  std::size_t newest_ = 0, count_ = 0;
  std::array<Difference, kNoiseLags> past_;
  std::size_t next_ = 0, known_ = 0;
};

}  // namespace condyle
