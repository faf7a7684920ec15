// SPDX-License-Identifier: Apache-2.0
// How far a prediction of a filter's error may be trusted, from the errors that came out.
//
//   y     error, in units of the filter's standard deviation, as are the others
//   g     its prediction; G its gate (motion_corrector.h); X = G g, y and X limited to +-5
//   B, A, C  running means of X y, X^2, y^2 over 5 s; Bs, As over 0.5 s
//   n     independent errors among them, one each 0.05 s
//   sd    of B/A: sqrt((C - B^2/A) / (n A))
//   alpha clamp(min(B/A - sd, Bs/As), 0, 1): the share of X that predicts y best
//
// PositionTrust: the same of the next position, which no teacher made.
//
//   u     innovation, in its standard deviations
//   X     the whole correction's effect on the predicted position, in the same unit
//   beta  clamp(min(B/A + sd, Bs/As + sds), 0, 1), sd = 1/sqrt(n A), each sample by itself: the
//         largest share that the positions do not contradict; 1 where they cannot tell
#pragma once

#include <algorithm>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// Running means for a regression through the origin.
template <class Scalar>
struct RegressionMeans {
  Scalar B = 0, A = 0, C = 0;

  void add(Scalar X, Scalar Y, Scalar gain) {
    B += (X * Y - B) * gain;
    A += (X * X - A) * gain;
    C += (Y * Y - C) * gain;
  }
};

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
    elapsed_s_ = std::min(elapsed_s_ + T, kMemory_s);
    const Scalar X = std::clamp(gate * g, -kLimit, kLimit), Y = std::clamp(y, -kLimit, kLimit);
    const Scalar slow = std::clamp(T / kMemory_s, Scalar(1) / (gathered_ + Scalar(5)), Scalar(1));
    const Scalar fast = std::clamp(T / kShortMemory_s, slow, Scalar(1));
    long_.add(X, Y, slow);
    short_.add(X, Y, fast);
  }

  /// Share of the gated prediction to use, 0 to 1.
  Scalar alpha() const {
    if (count_ < kFirst || !(long_.A > Scalar(0))) return 0;
    Scalar alpha = long_.B / long_.A - deviation(long_, elapsed_s_);
    if (short_.A > Scalar(0)) {
      alpha = std::min(alpha, short_.B / short_.A + deviation(short_, kShortMemory_s));
    }
    return std::clamp(alpha, Scalar(0), Scalar(1));
  }

  /// Errors so far, at most kFirst.
  int count() const { return count_; }

 private:
  static constexpr Scalar kLimit = 5, kMemory_s = 5, kShortMemory_s = Scalar(0.5);
  static constexpr Scalar kIndependent_s = Scalar(0.05);
  static constexpr Scalar kMostGathered = 100'000;

  // Of B/A over `memory_s`.
  static Scalar deviation(const RegressionMeans<Scalar>& means, Scalar memory_s) {
    const Scalar rest = std::max(means.C - means.B * means.B / means.A, Scalar(0));
    return std::sqrt(rest * kIndependent_s / (memory_s * means.A));
  }

  int count_ = 0;
  Scalar gathered_ = 0, elapsed_s_ = 0;
  RegressionMeans<Scalar> long_, short_;
};

/// What positions say of a correction.
template <class Scalar>
class PositionTrust {
 public:
  /// Adds an innovation `u`, `T` s after the last sample, and what the correction would have added.
  void add(Scalar u, Scalar X, Scalar T) {
    gathered_ = std::min(gathered_ + Scalar(1), kMostGathered);
    const Scalar Y = std::clamp(u, -kLimit, kLimit);
    X = std::clamp(X, -kLimit, kLimit);
    slow_ = std::clamp(T / kMemory_s, Scalar(1) / gathered_, Scalar(1));
    fast_ = std::clamp(T / kShortMemory_s, slow_, Scalar(1));
    long_.add(X, Y, slow_);
    short_.add(X, Y, fast_);
  }

  /// Largest share that they do not contradict, 0 to 1.
  Scalar beta() const {
    return std::clamp(std::min(largest(long_, slow_), largest(short_, fast_)), Scalar(0),
                      Scalar(1));
  }

 private:
  static constexpr Scalar kLimit = 5, kMemory_s = 5, kShortMemory_s = Scalar(0.5);
  static constexpr Scalar kMostGathered = 100'000;

  static Scalar largest(const RegressionMeans<Scalar>& means, Scalar gain) {
    if (!(means.A > Scalar(0))) return 1;
    return means.B / means.A + std::sqrt(gain / means.A);
  }

  Scalar gathered_ = 0, slow_ = 1, fast_ = 1;
  RegressionMeans<Scalar> long_, short_;
};

}  // namespace condyle
