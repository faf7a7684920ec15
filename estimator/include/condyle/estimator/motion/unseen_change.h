// SPDX-License-Identifier: Apache-2.0
// Adds to the variances shown the effect of a change of the motion that no filter has seen yet.
//
//   h       changes of the motion per second, kChangeRate
//   a, V    acceleration by a jaw's prior (m/s^2); variance of velocity that the prior and this
//           motion's speeds allow (m^2/s^2)
//   t       time since the last sample that was taken (s); T: time between samples
//   d, S    innovation of the newest sample along one axis (m), and its variance (m^2)
//
// Gap.    The motion has changed with probability s = h t: its acceleration by a, its velocity by
//         v = min(a t, sqrt(V)), its position by v t / 2. Position, velocity and acceleration vary
//         by s (v t / 2)^2, s v^2 and s a^2 more.
// Onset.  A sample beyond kNoticed standard deviations, though taken, may be the first of another
//         motion, with the odds
//            s / (1 - s) = h T N(d; S + V T^2) / N(d; S).
//         A velocity that changed within T then changed by 3/2 d/T: it varies by s (3/2 d/T)^2
//         more.
#pragma once

#include <algorithm>

#include "condyle/estimator/math/elementary.h"
#include "condyle/estimator/motion/white_jerk.h"

namespace condyle {

/// See the model above.
template <class Scalar>
class UnseenChange {
 public:
  /// `acceleration_variance`: a^2 (m^2/s^4); `velocity_variance`: V (m^2/s^2).
  UnseenChange(Scalar acceleration_variance, Scalar velocity_variance)
      : a2_(acceleration_variance), V_(velocity_variance) {}

  /// For position, velocity and acceleration, in a gap of `t` s.
  Vector3<Scalar> in_gap(Scalar t) const {
    const Scalar share = std::min(kChangeRate * t, Scalar(1));
    const Scalar v2 = std::min(a2_ * t * t, V_);
    return share * Vector3<Scalar>(v2 * t * t * Scalar(0.25), v2, a2_);
  }

  /// For the velocity (m^2/s^2), from a sample of innovation `d` (m) and variance `S` (m^2), `T` s
  /// after the previous one; 0 if it is as expected, and for T = 0.
  Scalar at_onset(Scalar d, Scalar S, Scalar T) const {
    if (!(d * d > kNoticed * kNoticed * S) || !(T > Scalar(0))) return 0;
    const Scalar wide = S + V_ * T * T;
    const Scalar log_odds =
        Scalar(0.5) * (d * d / S - d * d / wide - elementary::quick_log(wide / S)) +
        elementary::quick_log(kChangeRate * T);
    const Scalar share = Scalar(1) / (Scalar(1) + elementary::exp(-log_odds));
    const Scalar change_m_s = Scalar(1.5) * d / T;
    return share * change_m_s * change_m_s;
  }

 private:
  static constexpr Scalar kChangeRate = 2;
  static constexpr Scalar kNoticed = 2;

  Scalar a2_, V_;
};

}  // namespace condyle
