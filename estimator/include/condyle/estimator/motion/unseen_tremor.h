// SPDX-License-Identifier: Apache-2.0
// Adds to the variances shown a tremor of the jaw that the noise hides.
//
//   X, w    rms of the tremor's position along an axis (m), its angular frequency (rad/s)
//   R, T    variance of the noise that a filter makes out (m^2), time step (s)
//   P       covariance of a white-jerk filter (white_jerk.h), in units of R
//   b       bandwidth of the settled filter (rad/s), b^2 = 3/2 P_aa / P_vv; u = w/b
//   t       time of the later samples that the estimate rests on (s)
//
// The filter that rest leads to is slower than a tremor, does not follow it and takes it for noise.
// What it does not follow of it are errors of the variances
//   position        X^2      u^6/(1 + u^6)
//   velocity        X^2 w^2  u^4 (u^2 + 4)/(1 + u^6)
//   acceleration    X^2 w^4  u^2 (u^4 + 4)/(1 + u^6)
// All later samples reduce these factors to (u^6/(1 + u^6))^2; samples of the time t leave
// 1/(1 + x + x^2/2 + x^3/6), x = b t, of the difference. Added is what exceeds the errors that P
// has because the filter does not follow white jerk: a sixth, half and five sixths of its
// variances.
//
// Bounds.  X is the least of
//   kAcceleration_m_s2/w^2   Jaws at rest tremble by 9 um rms, those that hold a posture by 19 um
//                            (means of groups; Pfluegers Arch. 402 (1984) 76-82), at 6 to 8 Hz (S.
//                            Jaberzadeh et al., J. Physiol. 547 (2003) 613-620; P. F. Sowman et
//                            al., Mov. Disord. 23 (2008) 441-443). This is twice the latter, 40 um
//                            at 8 Hz.
//   sqrt(R)                  the tremor is part of R.
//   sqrt(3.2 w R T)          a larger one shows: it makes a filter of b > w the likeliest.
// w is where the first meets the others, within 8 to 12 Hz: there position, velocity and
// acceleration are largest. T is P_aa/(2 b^5).
//
// Source.  In continuous time and units of 1/b the settled filter has the gain (2, 2, 1) and
// P = T (2 2 1; 2 3 2; 1 2 2). With D(s) = s^3 + 2 s^2 + 2 s + 1, s = i u, it leaves the shares
// s^3/D of a position, s^2 (s + 2)/D of a velocity and s (s^2 + 2 s + 2)/D of an acceleration;
// their squares are the factors. All samples leave 1 - 1/(D(s) D(-s)). (A. Gelb, Applied Optimal
// Estimation (1974), sections 4.3 and 5.2.) The log likelihood of a second (P. Whittle, Ark. Mat. 2
// (1953) 423-434) is -b - k w/(1 + (b/w)^6), k = X^2/(2 w R T): for k below 1.57 largest at b = 0.
#pragma once

#include <algorithm>
#include <cmath>

#include "condyle/estimator/math/three_state_filter.h"

namespace condyle {

/// A white-jerk filter's covariance, and the variances of the values shown, in units of R.
template <class Scalar>
struct FilterShown {
  const SymmetricMatrix3<Scalar>& P;
  Vector3<Scalar> variance;
};
/// The filter's own values are shown.
template <class Scalar>
FilterShown<Scalar> shown_by_itself(const SymmetricMatrix3<Scalar>& P) {
  return {P, {P(0, 0), P(1, 1), P(2, 2)}};
}

/// See the model above.
template <class Scalar>
class UnseenTremor {
 public:
  static constexpr double kAcceleration_m_s2 = 0.1;                          ///< largest w^2 X
  static constexpr double kSquareRate_s2 = 2500, kMostSquareRate_s2 = 5700;  ///< range of w^2

  /// `acceleration_variance` (m^2/s^4): of a jaw's prior, which the tremor's does not exceed.
  explicit UnseenTremor(Scalar acceleration_variance)
      : acceleration_m_s2_(
            std::min(static_cast<Scalar>(kAcceleration_m_s2), std::sqrt(acceleration_variance))) {}

  /// What a tremor adds to the variances of position, velocity and acceleration (m^2, m^2/s^2,
  /// m^2/s^4) of a filter that makes out the noise `R` (m^2, positive), with the later samples of
  /// `later_s` s.
  Vector3<Scalar> of_filter(Scalar R, const FilterShown<Scalar>& filter, Scalar later_s) const {
    const Scalar aa = filter.P(kThird, kThird);
    Scalar b2 = Scalar(1.5) * aa / filter.P(kVelocity, kVelocity);
    if (!(b2 > kLeastSquareBandwidth_s2)) b2 = kLeastSquareBandwidth_s2;
    const Scalar b = std::sqrt(b2);
    const Scalar hidden = R * std::min(Scalar(1), kMostHidden_s * aa / (b2 * b2 * b));
    const Scalar w2 =
        std::clamp(acceleration_m_s2_ / std::sqrt(hidden), static_cast<Scalar>(kSquareRate_s2),
                   static_cast<Scalar>(kMostSquareRate_s2));
    const Scalar most_m = acceleration_m_s2_ / w2;
    const Scalar X2 = std::min(hidden, most_m * most_m);
    const Scalar u2 = w2 / b2, u4 = u2 * u2, u6 = u4 * u2;
    const Scalar scale = Scalar(1) / (Scalar(1) + u6);
    const Scalar all = u6 * scale;
    Vector3<Scalar> factors(all, u4 * (u2 + Scalar(4)) * scale, u2 * (u4 + Scalar(4)) * scale);
    if (later_s > Scalar(0)) {
      const Scalar x = b * later_s;
      const Scalar left =
          Scalar(1) / (Scalar(1) + x * (Scalar(1) + x * (Scalar(0.5) + x * (Scalar(1) / 6))));
      for (Scalar& factor : factors) factor = all * all + left * (factor - all * all);
    }
    const Vector3<Scalar> errors = X2 * factors.cwiseProduct(Vector3<Scalar>(1, w2, w2 * w2));
    const Vector3<Scalar> allowed = R * filter.variance.cwiseProduct(Vector3<Scalar>(
                                            Scalar(1) / 6, Scalar(1) / 2, Scalar(5) / 6));
    return (errors - allowed).cwiseMax(Scalar(0));
  }

  /// The same for a bank of filters along `axis`; `filter(i)` is that of member i.
  template <class Bank, class Filter>
  Vector3<Scalar> of_bank(const Bank& bank, int axis, const Filter& filter, Scalar later_s) const {
    Vector3<Scalar> sum = Vector3<Scalar>::Zero();
    Scalar weight_sum = 0;
    for (int i = 0; i < bank.member_count(); ++i) {
      const Scalar weight = bank.weight(axis, i);
      if (!(weight > Bank::Weights::kPlausible)) continue;
      sum += weight * of_filter(bank.stated_R(axis, i), filter(i), later_s);
      weight_sum += weight;
    }
    return sum / weight_sum;
  }

 private:
  static constexpr Scalar kLeastSquareBandwidth_s2 = 1;  // so that powers fit into a float
  static constexpr Scalar kMostHidden_s = 96;            // 3.2 w/2, w about 60

  Scalar acceleration_m_s2_;
};

}  // namespace condyle
