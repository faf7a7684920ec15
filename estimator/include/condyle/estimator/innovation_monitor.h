// SPDX-License-Identifier: Apache-2.0
// Is the filter consistent? Mean NIS and correlation of its innovations along one axis.
//
//   e     innovation / its predicted standard deviation; white with variance 1 if the model holds
//   NIS   e^2; its mean is 1 if the stated variances are right
//   rho   correlation of consecutive e, each limited to +-3 so that glitches do not decide it
//
// White noise through a filter of the right model gives rho = 0 +- 1/sqrt(n). Where the maker
// smooths the positions, neighbours share their noise and rho is positive; a white R is then wrong
// and so are the intervals. Jaw motion is not quite white jerk: on unsmoothed simulated chewing
// |rho| stays below 0.17 (tests/consistency), on smoothed real recordings it is 0.27 to 0.47.
// Smoothing over many samples at a low rate looks like a quiet instrument and cannot be told from
// one.
#pragma once

#include <algorithm>

#include "condyle/estimator/arithmetic.h"

namespace condyle {

/// Watches the innovations of one axis. Constant memory; beyond kMemory samples old ones fade.
template <class Scalar>
class InnovationMonitor {
 public:
  /// Correlation from which on the noise is said not to be white.
  static constexpr Scalar kSmoothedCorrelation = Scalar(0.25);
  /// Fewest samples for that; 0.25 is then 3.5 standard deviations of chance.
  static constexpr Scalar kFewestSamples = 200;

  /// Adds a standardised innovation, no unit; NaN where there was none.
  void add(Scalar standardised) {
    if (!std::isfinite(standardised)) {
      has_previous_ = false;
      return;
    }
    const Scalar limited = std::clamp(standardised, Scalar(-3), Scalar(3));
    count_ = std::min(count_ + Scalar(1), kMemory);
    nis_ += (standardised * standardised - nis_) / count_;
    limited_variance_ += (limited * limited - limited_variance_) / count_;
    if (has_previous_) {
      pair_count_ = std::min(pair_count_ + Scalar(1), kMemory);
      covariance_ += (limited * previous_ - covariance_) / pair_count_;
    }
    previous_ = limited;
    has_previous_ = true;
  }

  /// Number of innovations, at most kMemory.
  Scalar count() const { return count_; }
  /// Mean NIS; 0 before the first.
  Scalar mean_nis() const { return nis_; }
  /// Lag-1 correlation rho; 0 where nothing varies.
  Scalar correlation() const {
    return limited_variance_ > Scalar(0) ? covariance_ / limited_variance_ : Scalar(0);
  }
  /// True where the innovations say that the positions were smoothed before they came.
  bool looks_smoothed() const {
    return pair_count_ >= kFewestSamples && correlation() > kSmoothedCorrelation;
  }

 private:
  static constexpr Scalar kMemory = 100'000;

  Scalar count_ = 0, pair_count_ = 0;
  Scalar nis_ = 0, limited_variance_ = 0, covariance_ = 0;
  Scalar previous_ = 0;
  bool has_previous_ = false;
};

}  // namespace condyle
