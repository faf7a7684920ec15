// SPDX-License-Identifier: Apache-2.0
// The estimate of the whole pose at one instant, and what follows from it for any jaw-fixed point
// and any axis.
//
//   c, S_c   the body's centre in the instrument's frame (m), and its covariance
//   w        rotation vector from the reference orientation R_0 (rad): R = exp(w) R_0
//   S_r      covariance of a small rotation after R (rad^2), J S_w J' (rotation_vector.h)
//   o, S_o   angular velocity J dw/dt in the instrument's frame (rad/s), and its covariance
//   r        lever R (b - b_c) of the point b of the jaw from the centre b_c
//   point    c + r,        S_c + [r] S_r [r]'
//   velocity dc/dt + o x r,  S_v + [r] S_o [r]' + [o][r] S_r [r]'[o]'
//
// Errors of the centre and of the orientation count as independent: the centre must be the point
// that the instrument measures best. So do errors along different axes, and those of a position and
// its velocity. For three points that are noisy one by one, this holds as far as their triangle is
// as wide as high; else the orientation's errors about some axes are correlated.
#pragma once

#include "condyle/estimator/events.h"
#include "condyle/estimator/pose/rigid_body.h"
#include "condyle/estimator/pose/rotation_vector.h"
#include "condyle/estimator/provenance.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// A vector with its covariance, in the unit of the name that holds it and in its square.
template <class Scalar>
struct VectorEstimate {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();
  Vector3<Scalar> value = Vector3<Scalar>::Constant(kNone);
  Matrix3<Scalar> covariance = Matrix3<Scalar>::Constant(kNone);
  Provenance provenance = Provenance::not_computed;

  /// Along each axis.
  Vector3<Scalar> standard_deviation() const { return covariance.diagonal().cwiseSqrt(); }
};

/// A jaw-fixed point in the instrument's frame.
template <class Scalar>
struct PointEstimate {
  VectorEstimate<Scalar> position_m, velocity_m_s;
};

/// The turn from the reference as a swing after a twist about an axis (rotation_vector.h).
template <class Scalar>
struct TurnEstimate {
  Quantity<Scalar> twist_rad;
  Quantity<Scalar> twist_rate_rad_s;
  Quantity<Scalar> swing_rad;  ///< never negative: below about 2 standard deviations it is noise
};

/// The pose at one instant. NaN and `not_computed` if there are no values.
template <class Scalar>
struct PoseEstimate {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();

  bool is_ready = false;    ///< false while the lag fills
  TimeNs time_ns = 0;       ///< instant of the estimate
  bool time_valid = false;  ///< its time is known
  EventSet events;          ///< unusual properties of the sample of that instant
  Scalar nis = kNone;       ///< normalised innovation squared, six degrees of freedom

  VectorEstimate<Scalar> centre_m, centre_velocity_m_s;         ///< of the body's centre
  VectorEstimate<Scalar> rotation_vector_rad;                   ///< from the reference orientation
  VectorEstimate<Scalar> angular_velocity_rad_s;                ///< in the instrument's frame
  Matrix3<Scalar> rotation = Matrix3<Scalar>::Constant(kNone);  ///< jaw frame -> instrument's frame
  /// Of a small rotation about the instrument's axes that follows `rotation` (rad^2).
  Matrix3<Scalar> rotation_covariance_rad2 = Matrix3<Scalar>::Constant(kNone);
  Vector3<Scalar> body_centre_m = Vector3<Scalar>::Zero();  ///< in the jaw frame

  /// Position and orientation; their values are valid unless `not_computed`. One provenance for
  /// both, as for both rates: the weakest of all axes.
  Provenance provenance() const { return rotation_vector_rad.provenance; }

  /// The point `body_point_m` of the jaw frame.
  PointEstimate<Scalar> point(const Vector3<Scalar>& body_point_m) const {
    PointEstimate<Scalar> result;
    if (provenance() == Provenance::not_computed) return result;
    const Vector3<Scalar> lever_m = rotation * (body_point_m - body_centre_m);
    const Matrix3<Scalar> cross = cross_matrix(lever_m);
    const Matrix3<Scalar> turned = cross * rotation_covariance_rad2 * cross.transpose();
    result.position_m = {centre_m.value + lever_m, centre_m.covariance + turned, provenance()};
    const auto& rate = angular_velocity_rad_s;
    if (rate.provenance == Provenance::not_computed) return result;
    const Matrix3<Scalar> spin = cross_matrix(rate.value);
    result.velocity_m_s = {centre_velocity_m_s.value + rate.value.cross(lever_m),
                           centre_velocity_m_s.covariance +
                               cross * rate.covariance * cross.transpose() +
                               spin * turned * spin.transpose(),
                           rate.provenance};
    return result;
  }

  /// Twist about `axis`, a unit vector in the instrument's frame, fixed to the jaw in the reference
  /// orientation; and swing.
  TurnEstimate<Scalar> turn_about(const Vector3<Scalar>& axis) const {
    TurnEstimate<Scalar> result;
    if (provenance() == Provenance::not_computed) return result;
    const auto angles = swing_twist_of(rotation_vector_rad.value, axis);
    const Matrix3<Scalar>& S = rotation_covariance_rad2;
    result.twist_rad = quantity_of(
        angles.twist_rad, angles.twist_gradient.dot(S * angles.twist_gradient), provenance());
    // Without swing its direction is unknown: the sum over both directions across the axis.
    const Scalar swing_variance = angles.swing_rad > Scalar(0)
                                      ? angles.swing_gradient.dot(S * angles.swing_gradient)
                                      : S.trace() - axis.dot(S * axis);
    result.swing_rad = quantity_of(angles.swing_rad, swing_variance, provenance());
    const auto& rate = angular_velocity_rad_s;
    if (rate.provenance == Provenance::not_computed) return result;
    result.twist_rate_rad_s = quantity_of(
        angles.twist_gradient.dot(rate.value),
        angles.twist_gradient.dot(rate.covariance * angles.twist_gradient), rate.provenance);
    return result;
  }
};

}  // namespace condyle
