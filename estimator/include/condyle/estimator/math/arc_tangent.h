// SPDX-License-Identifier: Apache-2.0
// The angle of a vector in the plane, with the same bits on every machine (elementary.h).
//
//   z    the smaller of |x| and |y| over the larger, 0 to 1
//   a    first guess of atan z: z pi/4 + 0.273 z (1 - z), within 0.004
//   e    atan z - a, from tan e = (z cos a - sin a) / (cos a + z sin a); three terms
//
// Error below 3 ulp in double, 0.51 ulp in float, which computes in double; measured against long
// double by the tests, not proved.
#pragma once

#include "condyle/estimator/math/elementary.h"

namespace condyle::elementary {
namespace detail {

/// atan z for z from 0 to 1.
constexpr double arc_tangent_to_one(double z) {
  const double guess = z * 0x1.921fb54442d18p-1 + 0.273 * z * (1 - z);
  const double s = sin(guess), c = cos(guess);
  const double t = (z * c - s) / (c + z * s);
  const double square = t * t;
  return guess + (t - t * square * (1.0 / 3 - square / 5));
}

}  // namespace detail

/// Angle (rad) from the x axis to (x, y), -pi to pi; 0 for the zero vector, NaN unless both are
/// finite.
template <class Scalar>
constexpr Scalar atan2(Scalar y, Scalar x) {
  const double height = static_cast<double>(y < 0 ? -y : y);
  const double width = static_cast<double>(x < 0 ? -x : x);
  if (!(height < detail::kInfinity<double> && width < detail::kInfinity<double>)) {
    return detail::kNotANumber<Scalar>;
  }
  constexpr double kHalfTurn = 0x1.921fb54442d18p+1, kHalfTurnLow = 0x1.1a62633145c07p-53;
  double angle = 0;
  if (height > width) {
    angle = kHalfTurn / 2 - (detail::arc_tangent_to_one(width / height) - kHalfTurnLow / 2);
  } else if (width > 0) {
    angle = detail::arc_tangent_to_one(height / width);
  }
  if (x < 0) angle = kHalfTurn - (angle - kHalfTurnLow);
  return static_cast<Scalar>(y < 0 ? -angle : angle);
}

}  // namespace condyle::elementary
