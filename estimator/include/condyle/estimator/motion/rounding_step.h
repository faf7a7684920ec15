// SPDX-License-Identifier: Apache-2.0
// Finds the step to which a coordinate is rounded, from its samples.
//
//   d       difference of two samples in a row, those that repeat left out
//   g       candidate: the greatest common divisor of the differences so far, by Euclid
//
// The differences of a rounded coordinate are multiples of its step. Each d that is a multiple of g
// to kTolerance confirms it; a random d does so with probability 2 kTolerance. kConfirmations of
// them in a row make g the step. A non-multiple takes back kDoubt confirmations, so that a
// stray sample, which makes two, does not undo a step that has long been known; unconfirmed, g
// becomes its greatest common divisor with d, and below kLeast_m it starts anew.
//
// In float a coordinate of 0.3 m has 7 digits: steps below 0.1 mm may not be found there.
//
// Rounding adds noise of variance step^2 / 12 (B. Widrow, IRE Trans. Circuit Theory 3 (1956) 266).
// At rest, when a sample repeats the last, it does not show in any innovation, and no mean of
// samples makes it less: of a share s of repeats among the last 1/kRecentGain samples, s step^2 /
// 12 stays in the position.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle {

/// For one coordinate. No allocation; constant time.
template <class Scalar>
class RoundingStep {
 public:
  /// Takes the next sample's coordinate (m).
  void add(Scalar z_m) {
    const Scalar d = std::abs(z_m - last_m_);
    const Scalar digits_m = 4 * std::numeric_limits<Scalar>::epsilon() * std::abs(z_m);
    const bool is_first = !has_last_;
    last_m_ = z_m;
    has_last_ = true;
    if (!is_first) repeats_ += kRecentGain * ((d > Scalar(0) ? Scalar(0) : Scalar(1)) - repeats_);
    if (is_first || !(d > kLeast_m / 2 + digits_m) || !std::isfinite(d)) return;
    if (!(candidate_m_ > Scalar(0))) {
      begin(d);
      return;
    }
    const Scalar multiple = std::floor(d / candidate_m_ + Scalar(0.5));
    if (multiple > kFarther * largest_multiple_) return;  // g is not known well enough to decide
    const Scalar tolerance_m = kTolerance * candidate_m_ + digits_m;
    if (std::abs(d - multiple * candidate_m_) <= tolerance_m && multiple > Scalar(0)) {
      confirmations_ = std::min(confirmations_ + 1, kMostConfirmations);
      if (multiple > largest_multiple_) {
        largest_multiple_ = multiple;
        candidate_m_ = d / multiple;
      }
    } else if (confirmations_ >= kConfirmations) {
      confirmations_ -= kDoubt;
    } else {
      begin(common_divisor(d, candidate_m_, digits_m));
    }
  }

  /// The step (m); 0 if none was found.
  Scalar step_m() const { return confirmations_ >= kConfirmations ? candidate_m_ : Scalar(0); }

  /// The part of the noise of rounding that no number of samples removes from the position (m^2).
  Scalar lasting_variance_m2() const { return repeats_ * step_m() * step_m() / Scalar(12); }

 private:
  static constexpr Scalar kRecentGain = Scalar(1) / Scalar(16);
  static constexpr Scalar kLeast_m = Scalar(5e-7);
  static constexpr Scalar kTolerance = Scalar(0.02);
  static constexpr Scalar kFarther = 16;  // times the largest multiple seen so far
  static constexpr int kConfirmations = 20, kMostConfirmations = 200, kDoubt = 10;
  static constexpr int kMostDivisions = 40;

  void begin(Scalar candidate_m) {
    candidate_m_ = candidate_m > kLeast_m ? candidate_m : Scalar(0);
    largest_multiple_ = 1;
    confirmations_ = 0;
  }

  static Scalar common_divisor(Scalar a, Scalar b, Scalar digits_m) {
    for (int i = 0; i < kMostDivisions && b > kLeast_m; ++i) {
      const Scalar rest = std::abs(a - std::floor(a / b + Scalar(0.5)) * b);
      if (rest <= kTolerance * b + digits_m) return b;
      a = b;
      b = rest;
    }
    return 0;
  }

  bool has_last_ = false;
  Scalar last_m_ = 0, candidate_m_ = 0, largest_multiple_ = 1;
  int confirmations_ = 0;
  Scalar repeats_ = 0;  // s
};

}  // namespace condyle
