// SPDX-License-Identifier: Apache-2.0
// Rotations as vectors: exponential, logarithm, and what turns the rate of one into the other.
//
//   w        rotation vector (rad): axis times angle, |w| <= pi
//   [w]      matrix of the cross product: [w] x = w x x
//   exp      R = I + sinc |w| [w] + 1/2 sinc^2(|w|/2) [w]^2,  sinc x = sin(x) / x  (Rodrigues)
//   log      w = 2 atan2(|v|, c) v/|v| of the unit quaternion c, v with c >= 0
//   J        left Jacobian: exp(w + d) = exp(J d) exp(w) to first order, so that the angular
//            velocity in the outer frame is J dw/dt
//   J        = I + 1/2 sinc^2(|w|/2) [w] + s(|w|) [w]^2,  s(x) = (x - sin x) / x^3
//   J^-1     = I - 1/2 [w] + g(|w|) [w]^2,                g(x) = (1 - x/2 cot(x/2)) / x^2
//
// Every coefficient is a product, a quotient or a Taylor series that converges to |w| = pi, so
// small angles lose no digits.
//
// Swing and twist: exp(w) is a turn about a given axis, the twist, followed by a turn about an axis
// perpendicular to it, the swing. At a swing of pi the twist is undefined.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "condyle/estimator/math/arc_tangent.h"

namespace condyle {

/// The matrix [w]: cross_matrix(w) x = w cross x.
template <class Scalar>
Matrix3<Scalar> cross_matrix(const Vector3<Scalar>& w) {
  Matrix3<Scalar> matrix;
  matrix << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return matrix;
}

namespace internal {

/// sin(x) / x.
template <class Scalar>
Scalar sinc(Scalar x) {
  return x == Scalar(0) ? Scalar(1) : elementary::sin(x) / x;
}

/// (1 - cos x) / x^2.
template <class Scalar>
Scalar cosine_share(Scalar x) {
  const Scalar half = sinc(Scalar(0.5) * x);
  return Scalar(0.5) * half * half;
}

/// (x - sin x) / x^3, for |x| <= pi.
template <class Scalar>
Scalar sine_share(Scalar x) {
  constexpr auto kSeries = elementary::detail::reciprocal_factorials<Scalar, 14>(3, 2);
  return elementary::detail::polynomial(-x * x, kSeries);
}

/// (1 - x/2 cot(x/2)) / x^2, for |x| <= pi: (sin h - h cos h) / (4 h^2 sin h) with h = x/2.
template <class Scalar>
Scalar cotangent_share(Scalar x) {
  constexpr auto kFactorials = elementary::detail::reciprocal_factorials<Scalar, 11>(3, 2);
  const Scalar h = Scalar(0.5) * x;
  Scalar sum = 0;  // 2/3! - 4/5! h^2 + 6/7! h^4 ...
  for (std::size_t k = kFactorials.size(); k-- > 0;) {
    sum = Scalar(2 * k + 2) * kFactorials[k] - h * h * sum;
  }
  return sum / (Scalar(4) * sinc(h));
}

/// I + a [w] + b [w]^2.
template <class Scalar>
Matrix3<Scalar> with_powers(const Vector3<Scalar>& w, Scalar a, Scalar b) {
  const Matrix3<Scalar> cross = cross_matrix(w);
  Matrix3<Scalar> sum = a * cross + b * (cross * cross);
  // 3 + x - 2 for 1 + x: libgcc's double arithmetic for processors that have none rounds 1 - x
  // wrongly for x from 2^-33 to 2^-32.
  for (int i = 0; i < 3; ++i) sum(i, i) = (Scalar(3) + sum(i, i)) - Scalar(2);
  return sum;
}

}  // namespace internal

/// The rotation by `rotation_rad`.
template <class Scalar>
Matrix3<Scalar> rotation_of(const Vector3<Scalar>& rotation_rad) {
  const Scalar angle = rotation_rad.norm();
  return internal::with_powers(rotation_rad, internal::sinc(angle), internal::cosine_share(angle));
}

/// The rotation vector of `rotation`, which must be a rotation matrix; its length is at most pi.
template <class Scalar>
Vector3<Scalar> rotation_vector_of(const Matrix3<Scalar>& rotation) {
  Eigen::Quaternion<Scalar> q(rotation);
  if (q.w() < Scalar(0)) q.coeffs() = -q.coeffs();
  const Vector3<Scalar> v = q.vec();
  const Scalar sine = v.norm();
  // A sine whose square vanishes is its own angle.
  if (!(sine > Scalar(0))) return Scalar(2) * v;
  return (Scalar(2) * elementary::atan2(sine, q.w()) / sine) * v;
}

/// J at `rotation_rad`, of length at most pi.
template <class Scalar>
Matrix3<Scalar> left_jacobian(const Vector3<Scalar>& rotation_rad) {
  const Scalar angle = rotation_rad.norm();
  return internal::with_powers(rotation_rad, internal::cosine_share(angle),
                               internal::sine_share(angle));
}

/// J^-1 at `rotation_rad`, of length at most pi.
template <class Scalar>
Matrix3<Scalar> inverse_left_jacobian(const Vector3<Scalar>& rotation_rad) {
  return internal::with_powers(rotation_rad, Scalar(-0.5),
                               internal::cotangent_share(rotation_rad.norm()));
}

/// A rotation as swing after twist. The gradients are those of the angles to a small rotation, by
/// components about the outer frame's axes, that follows.
template <class Scalar>
struct SwingTwist {
  Scalar twist_rad = 0;  ///< about the axis, -pi to pi
  Scalar swing_rad = 0;  ///< about an axis perpendicular to it, 0 to pi
  Vector3<Scalar> twist_gradient = Vector3<Scalar>::Zero();
  Vector3<Scalar> swing_gradient = Vector3<Scalar>::Zero();  ///< 0 without swing
};

/// Swing and twist of the rotation by `rotation_rad` about `axis`, a unit vector. With c, v the
/// unit quaternion and p = v.axis: twist 2 atan2(p, c), swing 2 atan2(|v - p axis|, hypot(p, c)).
template <class Scalar>
SwingTwist<Scalar> swing_twist_of(const Vector3<Scalar>& rotation_rad,
                                  const Vector3<Scalar>& axis) {
  const Scalar half = Scalar(0.5) * rotation_rad.norm();
  const Scalar c = elementary::cos(half);
  const Vector3<Scalar> v = (Scalar(0.5) * internal::sinc(half)) * rotation_rad;
  const Scalar p = v.dot(axis);
  const Vector3<Scalar> across = v - p * axis;
  const Scalar sine = across.norm(), cosine = std::sqrt(c * c + p * p);
  SwingTwist<Scalar> result;
  result.twist_rad = Scalar(2) * elementary::atan2(p, c);
  result.swing_rad = Scalar(2) * elementary::atan2(sine, cosine);
  if (!(cosine > Scalar(0))) return result;
  // A small rotation e changes c by -e.v/2 and v by (c e + e x v)/2.
  const Vector3<Scalar> of_p = c * axis + v.cross(axis);
  result.twist_gradient = (c * of_p + p * v) / (cosine * cosine);
  if (!(sine > Scalar(0))) return result;
  const Vector3<Scalar> u = across / sine;
  result.swing_gradient = cosine * (c * u + v.cross(u)) - (sine / cosine) * (p * of_p - c * v);
  return result;
}

}  // namespace condyle
