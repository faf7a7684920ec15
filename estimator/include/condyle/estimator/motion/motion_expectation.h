// SPDX-License-Identifier: Apache-2.0
// The prediction of a bank of filters (filter_bank.h) for the next measurement, after `predict`.
//
//   nu, S    innovation of a member (m), and its variance in units of R
//   w, R, R' a member's weight, the noise (m^2) that it makes out, and the noise as it is stated
//
// Members with less weight than kPlausible do not count. The density of the mixture is sum w N(nu;
// R S) / sum w, with R or with R'.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "condyle/estimator/math/elementary.h"
#include "condyle/estimator/motion/filter_bank.h"

namespace condyle {

/// The prediction of a bank for the next measurement along one axis.
template <class Scalar>
struct Expectation {
  Scalar position_m{};   ///< mean of the mixture
  Scalar variance_m2{};  ///< of the innovation, as stated
  // innovation^2 / variance, with the noise that each member has estimated itself:
  Scalar of_likely_squared{};   ///< of the likely member that fits best
  Scalar of_mixture_squared{};  ///< of the mixture
};

/// Which noise a density rests on.
enum class Noise { stated, own };

/// The prediction of `bank` for the measurement `z_m` along `axis`.
template <class Scalar, int kAxes>
Expectation<Scalar> expectation(const FilterBank<Scalar, kAxes>& bank, int axis, Scalar z_m) {
  using Weights = typename FilterBank<Scalar, kAxes>::Weights;
  Expectation<Scalar> expected;
  Scalar weight_sum = 0, own_variance_m2 = 0;
  expected.of_likely_squared = std::numeric_limits<Scalar>::infinity();
  for (int i = 0; i < bank.member_count(); ++i) {
    const Scalar weight = bank.weight(axis, i);
    if (!(weight > Weights::kPlausible)) continue;
    const Scalar R = bank.R(axis, i), S = bank.innovation_variance(i);
    const Scalar position_m = bank.step(i).x[axis][kPosition];
    const Scalar innovation_m = z_m - position_m;
    weight_sum += weight;
    expected.position_m += weight * position_m;
    expected.variance_m2 += weight * bank.stated_R(axis, i) * S;
    own_variance_m2 += weight * R * S;
    if (weight > Weights::kLikelyWeight) {
      expected.of_likely_squared =
          std::min(expected.of_likely_squared, innovation_m * innovation_m / (R * S));
    }
  }
  expected.position_m /= weight_sum;
  expected.variance_m2 /= weight_sum;
  const Scalar innovation_m = z_m - expected.position_m;
  expected.of_mixture_squared = innovation_m * innovation_m * weight_sum / own_variance_m2;
  return expected;
}

/// Log density of the measurement `z_m` (1/m along each axis) by `bank`.
template <Noise kNoise, class Scalar, int kAxes>
Scalar log_density(const FilterBank<Scalar, kAxes>& bank, const Array<Scalar, kAxes>& z_m) {
  using Weights = typename FilterBank<Scalar, kAxes>::Weights;
  constexpr Scalar kTwoPi = Scalar(6.283185307179586);
  constexpr Scalar kLeastExponent = -80;  // e^-80 is still a number in float
  Scalar sum = 0;
  for (int axis = 0; axis < kAxes; ++axis) {
    Scalar density = 0, weight_sum = 0;
    for (int i = 0; i < bank.member_count(); ++i) {
      const Scalar weight = bank.weight(axis, i);
      if (!(weight > Weights::kPlausible)) continue;
      const Scalar innovation_m = z_m[axis] - bank.step(i).x[axis][kPosition];
      const Scalar R = kNoise == Noise::stated ? bank.stated_R(axis, i) : bank.R(axis, i);
      const Scalar variance_m2 = R * bank.innovation_variance(i);
      const Scalar exponent =
          std::max(Scalar(-0.5) * innovation_m * innovation_m / variance_m2, kLeastExponent);
      weight_sum += weight;
      density += weight * elementary::exp(exponent) / std::sqrt(kTwoPi * variance_m2);
    }
    sum +=
        elementary::quick_log(std::max(density / weight_sum, std::numeric_limits<Scalar>::min()));
  }
  return sum;
}

}  // namespace condyle
