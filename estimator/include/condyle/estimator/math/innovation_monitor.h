// SPDX-License-Identifier: Apache-2.0
// Checks for one axis of a run whether the filter is consistent and the noise white.
//
//   e     innovation / its predicted standard deviation; white with variance 1 if the model holds
//   NIS   e^2; its mean is 1 if the stated variances are right
//   rho   correlation of consecutive e, each limited to +-3 so that glitches do not decide it;
//         0 +- 1/sqrt(n) if the model holds
//   c_k   correlation of sixth differences of the measured positions, k samples apart. Differences
//         cancel a slow motion and leave the noise. White noise, whatever its size, gives
//         (-1)^k C(12, 6+k) / C(12, 6): -6/7, 15/28, ... and 0 from k = 7 on
//
// Smoothing by the manufacturer makes neighbours share their noise: a white R is then wrong, and so
// are the intervals. An adaptive filter hides part of that from rho, so c is checked as well: c_1
// is above -6/7 if a low pass left little noise, and a mean over n samples gives c_n near -1/2. A
// mean over more than kMostLags samples goes unnoticed.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// Mean square of numbers and their correlation up to `kLags` numbers apart. Beyond kMemory
/// numbers, old ones fade.
template <class Scalar, int kLags>
class Autocorrelation {
 public:
  /// Adds the next number; NaN breaks the chain.
  void add(Scalar value) {
    if (!std::isfinite(value)) {
      chained_ = 0;
      return;
    }
    count_ = std::min(count_ + Scalar(1), kMemory);
    variance_ += (value * value - variance_) / count_;
    for (int lag = 1; lag <= chained_; ++lag) {
      Scalar& pairs = pairs_[lag - 1];
      pairs = std::min(pairs + Scalar(1), kMemory);
      covariance_[lag - 1] += (value * past_[lag - 1] - covariance_[lag - 1]) / pairs;
    }
    for (int i = kLags - 1; i > 0; --i) past_[i] = past_[i - 1];
    past_[0] = value;
    chained_ = std::min(chained_ + 1, kLags);
  }
  /// Pairs `lag` numbers apart, at most kMemory.
  Scalar pairs(int lag = 1) const { return pairs_[lag - 1]; }
  /// Root mean square of the numbers.
  Scalar rms() const { return std::sqrt(variance_); }
  /// Correlation `lag` apart, -1 to 1; 0 if nothing varies.
  Scalar value(int lag = 1) const {
    return variance_ > Scalar(0) ? covariance_[lag - 1] / variance_ : Scalar(0);
  }

 private:
  static constexpr Scalar kMemory = 100'000;

  Scalar count_ = 0, variance_ = 0;
  Array<Scalar, kLags> pairs_ = {}, covariance_ = {};
  Array<Scalar, kLags> past_ = {};  // the last number first
  int chained_ = 0;                 // of `past_`
};

/// Correlation of sixth differences, up to kMostLags samples apart. The steps between positions
/// must be even to 10 %; otherwise a new chain starts.
template <class Scalar>
class NoiseColour {
 public:
  /// Largest lag that is checked.
  static constexpr int kMostLags = 32;

  /// Adds a position measured `step_s` after the previous one; NaN breaks the chain.
  void add(Scalar position_m, Scalar step_s) {
    const bool even = step_s > Scalar(0.9) * step_s_ && step_s < Scalar(1.1) * step_s_;
    step_s_ = step_s;
    if (!even || !std::isfinite(position_m)) {
      order_ = 0;
      add_difference(std::numeric_limits<Scalar>::quiet_NaN());
    }
    if (!std::isfinite(position_m)) return;
    // difference[k] of this position from the differences of the previous one
    Scalar difference = position_m;
    for (int k = 0; k <= order_; ++k) {
      const Scalar before = differences_[k];
      differences_[k] = difference;
      difference -= before;
    }
    if (order_ == kOrder) add_difference(differences_[kOrder]);
    order_ = std::min(order_ + 1, kOrder);
  }

  /// Number of pairs compared, `lag` samples apart.
  Scalar pairs(int lag = 1) const { return correlation_.pairs(lag); }
  /// Correlation c_lag.
  Scalar value(int lag = 1) const { return correlation_.value(lag); }
  /// Expected c_lag if the noise is white.
  static constexpr Scalar white(int lag) {
    constexpr Array<double, kOrder + 1> kBinomial = {924, -792, 495, -220, 66, -12, 1};
    const int distance = lag < 0 ? -lag : lag;
    return distance > kOrder ? Scalar(0) : static_cast<Scalar>(kBinomial[distance] / kBinomial[0]);
  }
  /// Standard deviation (m) of white noise with the same variation.
  Scalar noise_sd_m() const {
    constexpr Scalar kSumOfSquares = 924;  // of the binomial coefficients of six
    return correlation_.rms() / std::sqrt(kSumOfSquares);
  }
  /// False if nothing varies: there is then no noise to judge.
  bool varies() const { return correlation_.rms() > Scalar(0); }
  /// Standard deviation of c_lag from the pairs compared, if the noise is white (M. S. Bartlett,
  /// J. R. Stat. Soc. Suppl. 8 (1946) 27-41).
  Scalar white_sd(int lag) const {
    Scalar sum = 0;
    for (int j = 1; j <= lag + kOrder; ++j) {
      const Scalar term = white(j + lag) + white(j - lag) - Scalar(2) * white(j) * white(lag);
      sum += term * term;
    }
    return std::sqrt(sum / std::max(pairs(lag), Scalar(1)));
  }

 private:
  static constexpr int kOrder = 6;
  static constexpr int kFirst = 48;  // differences for the first scale

  // A glitch counts at most three times the usual size, also among the first differences: they wait
  // until their median gives the usual size.
  void add_difference(Scalar difference) {
    if (waiting_count_ == kFirst) return add_limited(difference, Scalar(3) * correlation_.rms());
    waiting_[waiting_count_++] = difference;
    if (waiting_count_ < kFirst) return;
    Array<Scalar, kFirst> sizes = {};
    int count = 0;
    for (const Scalar value : waiting_) {
      if (std::isfinite(value)) sizes[count++] = std::abs(value);
    }
    std::nth_element(&sizes[0], &sizes[0] + count / 2, &sizes[0] + count);
    const Scalar usual = Scalar(1.4826) * sizes[count / 2];  // median to standard deviation
    for (const Scalar value : waiting_) add_limited(value, Scalar(3) * usual);
  }

  void add_limited(Scalar difference, Scalar limit) {
    correlation_.add(limit > Scalar(0) ? std::clamp(difference, -limit, limit) : difference);
  }

  Array<Scalar, kOrder + 1> differences_ = {};
  int order_ = 0;  // highest difference that this position will have, at most kOrder
  Scalar step_s_ = 0;
  Array<Scalar, kFirst> waiting_ = {};
  int waiting_count_ = 0;
  Autocorrelation<Scalar, kMostLags> correlation_;
};

/// For the innovations of one axis: e, NIS and rho. Constant memory.
template <class Scalar>
class InnovationMoments {
 public:
  /// Fewest pairs for a judgement.
  static constexpr Scalar kFewestPairs = 200;
  /// Innovations count as correlated from this rho on, if it is also four standard deviations of
  /// chance. On unsmoothed simulated chewing |rho| stays below 0.07.
  static constexpr Scalar kCorrelated = Scalar(0.1);

  /// Adds a standardised innovation, no unit; NaN if there was none.
  void add(Scalar standardised) {
    innovation_.add(std::clamp(standardised, Scalar(-3), Scalar(3)));
    if (!std::isfinite(standardised)) return;
    count_ = std::min(count_ + Scalar(1), kMemory);
    nis_ += (standardised * standardised - nis_) / count_;
  }

  /// Innovations so far, at most kMemory.
  Scalar count() const { return count_; }
  /// Mean NIS; 0 before the first.
  Scalar mean_nis() const { return nis_; }
  /// rho.
  Scalar correlation() const { return innovation_.value(); }
  /// True if neighbouring innovations are correlated: the stated intervals do not hold.
  bool is_correlated() const {
    const Scalar rho = innovation_.value();
    return innovation_.pairs() >= kFewestPairs && rho > kCorrelated &&
           rho * rho * innovation_.pairs() > Scalar(16);
  }

 private:
  static constexpr Scalar kMemory = 100'000;

  Autocorrelation<Scalar, 1> innovation_;
  Scalar count_ = 0, nis_ = 0;
};

/// Watches the innovations and positions of one axis. Constant memory.
template <class Scalar>
class InnovationMonitor {
 public:
  /// Fewest pairs for a judgement.
  static constexpr Scalar kFewestPairs = InnovationMoments<Scalar>::kFewestPairs;
  /// Positions count as filtered if some c_k differs from that of white noise by this much, and by
  /// five standard deviations of chance.
  static constexpr Scalar kFilteredNeighbours = Scalar(0.057), kFilteredFarther = Scalar(0.2);

  /// Adds a sample: the standardised innovation, no unit, and the measured position, `step_s` after
  /// the previous one; NaN if there was none.
  void add(Scalar standardised, Scalar position_m, Scalar step_s) {
    noise_.add(position_m, step_s);
    innovations_.add(standardised);
  }

  /// As InnovationMoments.
  Scalar mean_nis() const { return innovations_.mean_nis(); }
  Scalar innovation_correlation() const { return innovations_.correlation(); }
  bool is_correlated() const { return innovations_.is_correlated(); }
  /// c_lag.
  Scalar noise_correlation(int lag = 1) const { return noise_.value(lag); }
  /// Standard deviation (m) of the noise from sixth differences.
  Scalar noise_sd_m() const { return noise_.noise_sd_m(); }
  /// The lag at which c_k differs most from that of white noise, in standard deviations of chance,
  /// if the noise is not white; 0 otherwise.
  int filtered_lag() const {
    int found = 0;
    Scalar largest = 5;
    if (!noise_.varies()) return found;
    for (int lag = 1; lag <= NoiseColour<Scalar>::kMostLags; ++lag) {
      if (noise_.pairs(lag) < kFewestPairs) continue;
      const Scalar difference = std::abs(noise_.value(lag) - NoiseColour<Scalar>::white(lag));
      const Scalar ratio = difference / noise_.white_sd(lag);
      if (difference > (lag == 1 ? kFilteredNeighbours : kFilteredFarther) && ratio > largest) {
        found = lag;
        largest = ratio;
      }
    }
    return found;
  }
  /// True if the noise of the positions is not white: they were filtered before.
  bool is_filtered() const { return filtered_lag() > 0; }

 private:
  InnovationMoments<Scalar> innovations_;
  NoiseColour<Scalar> noise_;
};

}  // namespace condyle
