// SPDX-License-Identifier: Apache-2.0
// Odds that an unexpected sample is a change of the motion, not an outlier.
//
//   T, V    time since the motion was last measured (s); variance of velocity that a jaw's prior
//           and this motion's speeds allow (m^2/s^2)
//   d, S    innovation of that sample along one axis (m), and its variance (m^2); S' = S + V T^2
//   nu      innovation of a later sample
//   o       log odds of change against outlier; s = 1 / (1 + e^-o), the share of change
//   u       density of outliers, anywhere within 50 mm (1/m)
//   C, G    changes and outliers that were decided so far, older ones count less
//
// Start.   o = log N(d; S') - log u, between kLeast and kMost. At kMost the sample may well be a
//          change, below it is an outlier that a change could hardly make. If outliers outnumber
//          changes, o is less by log (G / C): of an instrument that often fails, two outliers in a
//          row are likelier than a motion of their speed.
//          Each further sample in a row that the motion did not expect adds log 2: of a burst that
//          goes on. The density of d is then that of a Cauchy distribution of the width sqrt(S'):
//          a jaw rarely starts at ten times its usual speed, but less rarely than the tail of a
//          normal distribution says.
//          If the question is open already, o does not fall.
// Tests.   A later sample adds log p_change - log p_outlier, where each p is at least that of one
//          more outlier: outliers come in bursts, and the next is about as far off as the first,
//          N(nu; S + (2 d)^2), with probability 1/2 if the motion goes on, e^-3 if it
//          changed.
// End.     o > kSure: a change. o < -kUnlikely, and the motion expected the sample: an outlier.
//          After kMostTests the likelier.
#pragma once

#include <algorithm>

#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/math/elementary.h"

namespace condyle {

/// The odds.
template <class Scalar, int kAxes>
class ChangeOdds {
 public:
  using Each = Array<Scalar, kAxes>;  ///< one scalar for each axis
  enum class Decision { open, outlier, change };

  static constexpr Scalar kOutlierDensity = 20;           ///< 1/m
  static constexpr Scalar kBurstInMotion = Scalar(-0.7);  ///< log 1/2
  static constexpr Scalar kBurstInChange = -3;

  /// Properties of a sample that opens the question.
  struct Background {
    bool is_open = false;  ///< the question is open already
    int unexpected = 1;    ///< unexpected samples in a row, this one included
  };

  /// A sample of `innovation_m` and `variance_m2` opens the question; `spread_m2`: V T^2. Returns
  /// whether it may well be a change.
  bool start(const Each& innovation_m, const Each& variance_m2, Scalar spread_m2,
             const Background& background) {
    const Scalar before = background.is_open ? odds_ : kLeast;
    odds_ = kInRow * static_cast<Scalar>(background.unexpected - 1);
    for (int axis = 0; axis < kAxes; ++axis) {
      const Scalar d = innovation_m[axis], variance = variance_m2[axis] + spread_m2;
      odds_ += background.unexpected > 1 ? log_cauchy(d, variance) : log_normal(d, variance);
      odds_ -= log(kOutlierDensity);
      burst_variance_m2_[axis] = 4 * d * d;
    }
    const bool may_be_change = odds_ >= kMost;
    const Scalar rarity = std::min(log(changes_ / outliers_), Scalar(0));
    odds_ = std::max({std::clamp(odds_, kLeast, kMost) + rarity, kLeast, before});
    tests_ = 0;
    return may_be_change || odds_ >= kMost;
  }

  /// Log density (1/m along each axis) of one more outlier, each being followed by another with
  /// probability e^`share`.
  Scalar log_burst(const Each& innovation_m, const Each& variance_m2, Scalar share) const {
    for (int axis = 0; axis < kAxes; ++axis) {
      share += log_normal(innovation_m[axis], variance_m2[axis] + burst_variance_m2_[axis]);
    }
    return share;
  }

  /// Tests with a sample of these log densities; `is_expected` by the previous motion.
  Decision test(Scalar of_change, Scalar of_outlier, bool is_expected) {
    odds_ += of_change - of_outlier;
    ++tests_;
    const bool is_over = tests_ >= kMostTests;
    if ((is_expected && odds_ < -kUnlikely) || (is_over && !(odds_ > Scalar(0)))) {
      count(outliers_);
      return Decision::outlier;
    }
    if (odds_ > kSure || is_over) {
      count(changes_);
      return Decision::change;
    }
    return Decision::open;
  }

  /// s.
  Scalar share_of_change() const { return Scalar(1) / (Scalar(1) + elementary::exp(-odds_)); }
  /// False if a change is an unlikely cause of these samples.
  bool is_conceivable() const { return odds_ > kConceivable; }

 private:
  static constexpr Scalar kPi = Scalar(3.141592653589793);
  static constexpr Scalar kLeast = Scalar(-4.5), kMost = -1;
  static constexpr Scalar kConceivable = -4;     // s = 2 %
  static constexpr Scalar kInRow = Scalar(0.7);  // log 2
  static constexpr Scalar kSure = 4, kUnlikely = 3;
  static constexpr int kMostTests = 10;
  static constexpr Scalar kForgotten = Scalar(0.02);

  // One more outlier or change; earlier ones count less.
  void count(Scalar& decided) {
    outliers_ += kForgotten * (Scalar(1) - outliers_);
    changes_ += kForgotten * (Scalar(1) - changes_);
    decided += 1;
  }

  static Scalar log(Scalar x) { return elementary::quick_log(x); }
  static Scalar log_normal(Scalar x, Scalar variance) {
    return Scalar(-0.5) * (x * x / variance + log(2 * kPi * variance));
  }

  static Scalar log_cauchy(Scalar x, Scalar square_width) {
    return -log(kPi * (Scalar(1) + x * x / square_width)) - Scalar(0.5) * log(square_width);
  }

  Scalar odds_ = 0;
  int tests_ = 0;                      // samples that have tested since the start
  Scalar outliers_ = 1, changes_ = 1;  // decided so far
  Each burst_variance_m2_ = {};
};

}  // namespace condyle
