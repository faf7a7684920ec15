// SPDX-License-Identifier: Apache-2.0
// Is the filter consistent, and is the noise white? For one axis of a run.
//
//   e     innovation / its predicted standard deviation; white with variance 1 if the model holds
//   NIS   e^2; its mean is 1 if the stated variances are right
//   rho   correlation of consecutive e, each limited to +-3 so that glitches do not decide it;
//         0 +- 1/sqrt(n) if the model holds
//   c     correlation of consecutive sixth differences of the measured positions. They cancel a
//   slow
//         motion and leave the noise: white noise gives -6/7 whatever its size (differences of
//         order k: -k/(k+1)); noise that was smoothed before it came gives more.
//
// A maker who smooths makes neighbours share their noise: a white R is then wrong, and so are the
// intervals. An adaptive filter hides part of that from rho, so c is looked at as well.
#pragma once

#include <algorithm>

#include "condyle/estimator/arithmetic.h"

namespace condyle {

/// Mean of numbers and correlation of neighbours, all limited. Beyond kMemory numbers old ones
/// fade.
template <class Scalar>
class NeighbourCorrelation {
 public:
  /// Adds the next number; NaN breaks the chain.
  void add(Scalar value) {
    if (!std::isfinite(value)) {
      has_previous_ = false;
      return;
    }
    count_ = std::min(count_ + Scalar(1), kMemory);
    variance_ += (value * value - variance_) / count_;
    if (has_previous_) {
      pairs_ = std::min(pairs_ + Scalar(1), kMemory);
      covariance_ += (value * previous_ - covariance_) / pairs_;
    }
    previous_ = value;
    has_previous_ = true;
  }
  /// Pairs of neighbours, at most kMemory.
  Scalar pairs() const { return pairs_; }
  /// Root mean square of the numbers.
  Scalar rms() const { return std::sqrt(variance_); }
  /// Correlation of neighbours, -1 to 1; 0 where nothing varies.
  Scalar value() const { return variance_ > Scalar(0) ? covariance_ / variance_ : Scalar(0); }

 private:
  static constexpr Scalar kMemory = 100'000;

  Scalar count_ = 0, pairs_ = 0, variance_ = 0, covariance_ = 0, previous_ = 0;
  bool has_previous_ = false;
};

/// Correlation of neighbouring sixth differences. The steps between positions must be even to 10 %;
/// where they are not, it starts a new chain.
template <class Scalar>
class NoiseColour {
 public:
  /// Adds a position measured `step_s` after the one before; NaN breaks the chain.
  void add(Scalar position_m, Scalar step_s) {
    const bool even = step_s > Scalar(0.9) * step_s_ && step_s < Scalar(1.1) * step_s_;
    step_s_ = step_s;
    if (!even || !std::isfinite(position_m)) {
      order_ = 0;
      correlation_.add(std::numeric_limits<Scalar>::quiet_NaN());
    }
    if (!std::isfinite(position_m)) return;
    // difference[k] of this position from the differences of the one before
    Scalar difference = position_m;
    for (int k = 0; k <= order_; ++k) {
      const Scalar before = differences_[k];
      differences_[k] = difference;
      difference -= before;
    }
    if (order_ == kOrder) correlation_.add(limited(differences_[kOrder]));
    order_ = std::min(order_ + 1, kOrder);
  }

  /// Number of pairs compared.
  Scalar pairs() const { return correlation_.pairs(); }
  /// Correlation c.
  Scalar value() const { return correlation_.value(); }

 private:
  static constexpr int kOrder = 6;

  // A glitch counts no more than three times what is usual.
  Scalar limited(Scalar difference) const {
    const Scalar limit = Scalar(3) * correlation_.rms();
    return correlation_.pairs() < Scalar(kOrder) ? difference
                                                 : std::clamp(difference, -limit, limit);
  }

  Array<Scalar, kOrder + 1> differences_ = {};
  int order_ = 0;  // highest difference that this position will have, at most kOrder
  Scalar step_s_ = 0;
  NeighbourCorrelation<Scalar> correlation_;
};

/// Watches the innovations and positions of one axis. Constant memory.
template <class Scalar>
class InnovationMonitor {
 public:
  /// Fewest pairs that anything is said from.
  static constexpr Scalar kFewestPairs = 200;
  /// Innovations are said to be correlated from this rho on, if it is also four standard deviations
  /// of chance. On unsmoothed simulated chewing |rho| stays below 0.07.
  static constexpr Scalar kCorrelated = Scalar(0.1);
  /// Correlation of neighbouring sixth differences of white noise.
  static constexpr Scalar kWhite = Scalar(-6) / Scalar(7);
  /// Positions are said to be smoothed where c is above kWhite by this much, if that is also five
  /// standard deviations of chance, which for n pairs is 0.32/sqrt(n) (measured).
  static constexpr Scalar kSmoothed = Scalar(0.057);

  /// Adds what one sample said: the standardised innovation, no unit, and the measured position,
  /// `step_s` after the one before; NaN where there was none.
  void add(Scalar standardised, Scalar position_m, Scalar step_s) {
    noise_.add(position_m, step_s);
    innovation_.add(std::clamp(standardised, Scalar(-3), Scalar(3)));
    if (!std::isfinite(standardised)) return;
    count_ = std::min(count_ + Scalar(1), kMemory);
    nis_ += (standardised * standardised - nis_) / count_;
  }

  /// Mean NIS; 0 before the first.
  Scalar mean_nis() const { return nis_; }
  /// rho.
  Scalar innovation_correlation() const { return innovation_.value(); }
  /// c; -6/7 if the noise is white.
  Scalar noise_correlation() const { return noise_.value(); }
  /// True where neighbouring innovations are correlated: the stated intervals do not hold.
  bool is_correlated() const {
    const Scalar rho = innovation_.value();
    return innovation_.pairs() >= kFewestPairs && rho > kCorrelated &&
           rho * rho * innovation_.pairs() > Scalar(16);
  }
  /// True where no white noise is left in the positions.
  bool is_smoothed() const {
    const Scalar above = noise_.value() - kWhite;
    return noise_.pairs() >= kFewestPairs && above > kSmoothed &&
           above * above * noise_.pairs() > Scalar(2.56);
  }

 private:
  static constexpr Scalar kMemory = 100'000;

  NeighbourCorrelation<Scalar> innovation_;
  NoiseColour<Scalar> noise_;
  Scalar count_ = 0, nis_ = 0;
};

}  // namespace condyle
