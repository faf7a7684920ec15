// SPDX-License-Identifier: Apache-2.0
// How far a prediction of a filter's error may be trusted, from the errors that came out.
//
//   y     error, in units of the filter's standard deviation, as are the others
//   g     its prediction; G its gate (motion_corrector.h)
//   B, A  running means of G g y and (G g)^2, factors limited to +-5, over 5 s; Bs, As over 0.5 s
//   alpha clamp(min(B/A, Bs/As), 0, 1): the share of G g that predicts y best
#pragma once

#include <algorithm>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// Trust in the predictions of one output.
template <class Scalar>
class OutputTrust {
 public:
  /// Errors that are needed before anything is trusted.
  static constexpr int kFirst = 60;

  /// Adds an error `T` s after the last.
  void add(Scalar y, Scalar g, Scalar gate, Scalar T) {
    if (count_ < kFirst) ++count_;
    gathered_ = std::min(gathered_ + Scalar(1), kMostGathered);
    const Scalar X = std::clamp(gate * g, -kLimit, kLimit), Y = std::clamp(y, -kLimit, kLimit);
    const Scalar slow = std::clamp(T / kMemory_s, Scalar(1) / (gathered_ + Scalar(5)), Scalar(1));
    const Scalar fast = std::clamp(T / kShortMemory_s, slow, Scalar(1));
    long_.add(X, Y, slow);
    short_.add(X, Y, fast);
  }

  /// Share of the gated prediction to use, 0 to 1.
  Scalar alpha() const {
    if (count_ < kFirst || !(long_.A > Scalar(0))) return 0;
    Scalar alpha = long_.B / long_.A;
    if (short_.A > Scalar(0)) alpha = std::min(alpha, short_.B / short_.A);
    return std::clamp(alpha, Scalar(0), Scalar(1));
  }

  /// Errors so far, at most kFirst.
  int count() const { return count_; }

 private:
  static constexpr Scalar kLimit = 5, kMemory_s = 5, kShortMemory_s = Scalar(0.5);
  static constexpr Scalar kMostGathered = 100'000;

  struct Means {
    Scalar B = 0, A = 0;
    void add(Scalar X, Scalar Y, Scalar gain) {
      B += (X * Y - B) * gain;
      A += (X * X - A) * gain;
    }
  };

  int count_ = 0;
  Scalar gathered_ = 0;
  Means long_, short_;
};

}  // namespace condyle
