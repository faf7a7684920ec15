// SPDX-License-Identifier: Apache-2.0
// Number of samples in a mean that forgets: the memory of a bank of filters (filter_bank.h).
//
//   T    mean time step (s)
//   n    samples that the mean rests on; the next one has the share 1/n in it
//
// n grows by kGrowth a sample up to `memory_s`, so that the first guess is forgotten as n^-3, not
// as 1/n. An unexpected sample reduces n, because earlier knowledge may no longer hold.
#pragma once

#include <algorithm>

namespace condyle {

/// The memory. One object per run.
template <class Scalar>
class SampleMemory {
 public:
  /// `memory_s`: longest memory (s), above 0.
  explicit SampleMemory(Scalar memory_s) : memory_s_(memory_s) {}

  /// Forgets all samples; the guess counts as kFirst of them.
  void start() {
    n_ = kFirst;
    mean_step_s_ = 0;
  }

  /// Counts one more sample, `T` s after the last. Returns its share in the means.
  Scalar grow(Scalar T) {
    n_ += kGrowth;
    mean_step_s_ += mean_step_s_ > Scalar(0) ? (T - mean_step_s_) / n_ : T;
    // Compared without a division: steps may be 0.
    if (n_ * mean_step_s_ > memory_s_) n_ = std::max(memory_s_ / mean_step_s_, kFirst);
    return Scalar(1) / n_;
  }

  /// Older samples count less; called after an unexpected sample.
  void shorten() { n_ = std::max(n_ * kKept, kFirst); }

  /// Number of samples.
  Scalar n() const { return n_; }
  /// Mean time step (s); 0 before the second sample.
  Scalar mean_step_s() const { return mean_step_s_; }

 private:
  static constexpr Scalar kFirst = 5;
  static constexpr Scalar kGrowth = Scalar(1) / Scalar(3);
  static constexpr Scalar kKept = Scalar(0.9);

  Scalar memory_s_;
  Scalar n_ = kFirst, mean_step_s_ = 0;
};

}  // namespace condyle
