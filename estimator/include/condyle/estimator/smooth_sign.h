// SPDX-License-Identifier: Apache-2.0
// The sign of a velocity, smooth about zero, as Coulomb friction needs it: tanh(v / vs).
//
//   v0, v1    velocity at the begin and the end of a step (m/s), linear between
//   vs        velocity over which the sign changes (m/s)
//   M         mean of tanh(v / vs) over the step:
//             vs / (v1 - v0) (log cosh(v1 / vs) - log cosh(v0 / vs))
//
// The mean, not the value at an end: a jaw turns within a step, and friction then acts both ways.
#pragma once

#include "condyle/estimator/elementary.h"

namespace condyle {

/// M and its derivatives with respect to v0 and v1 (s/m).
template <class Scalar>
struct MeanSign {
  Scalar value = 0, of_begin = 0, of_end = 0;
};

/// M for velocities `v0` and `v1`, `vs` > 0 (m/s).
template <class Scalar>
MeanSign<Scalar> mean_sign(Scalar v0, Scalar v1, Scalar vs) {
  using std::abs;
  const Scalar change = v1 - v0;
  if (abs(change) < Scalar(0.02) * vs) {  // else it would be a difference of equal numbers
    const Scalar middle = elementary::tanh((v0 + v1) / (Scalar(2) * vs));
    const Scalar slope = (Scalar(1) - middle * middle) / (Scalar(2) * vs);
    return {middle, slope, slope};
  }
  const auto log_cosh = [](Scalar x) {
    const Scalar size = abs(x);
    return size + elementary::log((Scalar(1) + elementary::exp(-Scalar(2) * size)) / Scalar(2));
  };
  const Scalar mean = vs / change * (log_cosh(v1 / vs) - log_cosh(v0 / vs));
  return {mean, (mean - elementary::tanh(v0 / vs)) / change,
          (elementary::tanh(v1 / vs) - mean) / change};
}

/// The velocity at the end of a step that would end with `free_end` (m/s) without Coulomb friction
/// and that loses `most` >= 0 (m/s) to it at full sliding: the one root of
/// v1 + most M(v0, v1) = free_end, by bisection.
template <class Scalar>
Scalar braked_velocity(Scalar v0, Scalar free_end, Scalar most, Scalar vs) {
  Scalar low = free_end - most, high = free_end + most;
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const Scalar middle = low + (high - low) / Scalar(2);
    (middle + most * mean_sign(v0, middle, vs).value < free_end ? low : high) = middle;
  }
  return low + (high - low) / Scalar(2);
}

}  // namespace condyle
