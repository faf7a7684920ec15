// SPDX-License-Identifier: Apache-2.0
// The compact kernel that turns samples into smooth values and derivatives, without differences of
// samples (M. Shinbrot, Trans. ASME 79 (1957) 583: the method of modulating functions).
//
//   h        half-width (s)
//   phi(t)   C (1 - t^2/h^2)^8 for |t| < h, 0 elsewhere; C makes its integral 1
//   T        step of the samples z_k at t_k (s)
//   n        number of samples under the kernel
//
// Value, slope and curvature at t, by parts:
//          z_f = T sum phi(t - t_k) z_k,  z_f' = T sum phi'(t - t_k) z_k,  z_f'' = T sum phi'' z_k
// Width:   phi passes frequencies up to about w_c = sqrt(19) / h (rad/s): 19 / h^2 is the inverse
//          of its variance
// Noise:   white noise of variance s^2 in z_k has variances s^2 G0, s^2 G2, s^2 G4 in z_f, z_f' and
//          z_f'', and the covariance -s^2 G2 of z_f with z_f''; z_f' is apart from both. Over whole
//          samples G0 = T^2 sum phi^2, G2 = T^2 sum phi'^2, G4 = T^2 sum phi''^2.
#pragma once

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// phi, phi' and phi'' at one distance (1/s, 1/s^2, 1/s^3).
template <class Scalar>
struct KernelWeights {
  Scalar value = 0, slope = 0, curvature = 0;
};

/// Variances of smooth values, per unit variance of a sample; see above (1, 1/s^2, 1/s^4).
struct KernelGains {
  double G0 = 0, G2 = 0, G4 = 0;
};

/// phi for one half-width. Fixed size, + - * / only.
template <class Scalar>
class ModulatingKernel {
 public:
  /// 1 / (variance of phi / h^2).
  static constexpr double kInverseVariance = 19;

  /// `half_width_s` > 0.
  explicit ModulatingKernel(Scalar half_width_s)
      : half_width_s_(half_width_s), scale_(Scalar(kNormalisation) / half_width_s) {}

  Scalar half_width_s() const { return half_width_s_; }

  /// The weights at `distance_s`; zero from the half-width on.
  KernelWeights<Scalar> at(Scalar distance_s) const {
    const Scalar s = distance_s / half_width_s_, q = Scalar(1) - s * s;
    if (!(q > Scalar(0))) return {};
    const Scalar q2 = q * q, q6 = q2 * q2 * q2, q7 = q6 * q;
    return {
        scale_ * q7 * q, scale_ * Scalar(-16) * s * q7 / half_width_s_,
        scale_ * (Scalar(-16) * q7 + Scalar(224) * s * s * q6) / (half_width_s_ * half_width_s_)};
  }

  /// The effect on white noise of samples `step_s` apart.
  KernelGains gains(double step_s) const {
    KernelGains gains;
    const ModulatingKernel<double> exact(static_cast<double>(half_width_s_));
    const int reach = static_cast<int>(static_cast<double>(half_width_s_) / step_s) + 1;
    for (int k = -reach; k <= reach; ++k) {
      const KernelWeights<double> phi = exact.at(k * step_s);
      gains.G0 += phi.value * phi.value;
      gains.G2 += phi.slope * phi.slope;
      gains.G4 += phi.curvature * phi.curvature;
    }
    const double T2 = step_s * step_s;
    return {gains.G0 * T2, gains.G2 * T2, gains.G4 * T2};
  }

 private:
  // 1 / integral of (1 - s^2)^8 from -1 to 1, which is 2 (2/3) (4/5) ... (16/17).
  static constexpr double kNormalisation =
      0.5 * (3.0 * 5 * 7 * 9 * 11 * 13 * 15 * 17) / (2.0 * 4 * 6 * 8 * 10 * 12 * 14 * 16);

  Scalar half_width_s_, scale_;
};

}  // namespace condyle
