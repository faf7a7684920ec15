// SPDX-License-Identifier: Apache-2.0
// The pose of the jaw, from three points or from the device, and any point fixed to the jaw.
//
//   b_i   point i in the jaw frame, p_i the same point in the instrument's frame (m)
//   R, t  the pose: a point b of the jaw is at R b + t
//   fit   the R, t with det R = +1 that minimise sum |R b_i + t - p_i|^2, by the singular values of
//         the points' covariance: Arun, Huang, Blostein 1987 (doi 10.1109/TPAMI.1987.4767965); with
//         the sign that keeps R a rotation, also of coplanar points, as three always are: Umeyama
//         1991 (doi 10.1109/34.88573)
//
// The jaw frame follows from the three points alone, whatever the pose of the first sample:
//   origin  point 1
//   x       along point 3 -> point 2 (left-right)
//   z       in the points' plane, perpendicular to x, towards the midpoint of points 2 and 3
//   y       z cross x, so that x cross y = z: right-handed
// A bite fork with points at (0, 0, 0), (25, 0, 30), (-25, 0, 30) mm has just these coordinates.
//
// The three points of a bite fork are virtual points of one rigid body that the device has fitted.
// Their noise has six degrees of freedom, not nine: averaging them gains nothing, and the fit
// returns each point with its original error.
//
// Three points reveal a broken rigidity only through their three distances. A point that jumps out
// of their plane hardly changes these, and the pose follows it unnoticed.
//
// Programs use double here, as coordinates arrive; an estimator in float converts the position that
// it follows.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/math/eigen_solvers.h"

namespace condyle {

/// Smallest height of a triangle of points that is usable as a body: with less, 0.1 mm of noise
/// turns the jaw by more than a degree.
inline constexpr double kSmallestHeight_m = 5e-3;
/// Root mean square residual of a fit beyond which the points have not kept their distances.
inline constexpr double kRigidTolerance_m = 2e-3;
/// A quaternion's norm may differ from 1 by this much: digits lost in printing.
inline constexpr double kUnitNormTolerance = 1e-3;

/// Result of computing a pose or a position.
enum class PoseStatus : std::uint8_t {
  ok,
  unavailable,     ///< samples of this kind do not have it
  missing,         ///< a coordinate is absent, NaN or infinite
  unsettled,       ///< the points' distances are still being learned
  degenerate,      ///< the points coincide or lie on a line
  not_rigid,       ///< the points have not kept their distances: one has jumped
  not_a_rotation,  ///< the quaternion's norm is not 1
};

/// Position and orientation of the jaw in the instrument's frame.
template <class Scalar>
struct Pose {
  Matrix3<Scalar> rotation = Matrix3<Scalar>::Identity();  ///< jaw frame -> instrument's frame
  Vector3<Scalar> translation = Vector3<Scalar>::Zero();   ///< of the jaw frame's origin (m)
};

/// A pose and the status of its computation.
template <class Scalar>
struct PoseFit {
  Pose<Scalar> pose;          ///< valid if `status` is ok
  Scalar residual_rms_m = 0;  ///< over the three points; 0 without a fit
  PoseStatus status = PoseStatus::ok;
};

/// The point `body_point_m` of the jaw frame in the instrument's frame, metres.
template <class Scalar>
Vector3<Scalar> point_of(const Pose<Scalar>& pose,
                         const std::type_identity_t<Vector3<Scalar>>& body_point_m) {
  return pose.rotation * body_point_m + pose.translation;
}

/// The pose at `position_m` with the unit quaternion w, x, y, z, which is normalised. Status:
/// missing if a number is not finite; not_a_rotation if the norm differs from 1 by more than
/// kUnitNormTolerance.
template <class Scalar>
PoseFit<Scalar> pose_from_quaternion(const Vector3<Scalar>& position_m,
                                     const Eigen::Matrix<Scalar, 4, 1>& quaternion_wxyz) {
  PoseFit<Scalar> result;
  if (!position_m.allFinite() || !quaternion_wxyz.allFinite()) {
    result.status = PoseStatus::missing;
    return result;
  }
  const Scalar norm = quaternion_wxyz.norm();
  if (!(std::abs(norm - 1) <= Scalar(kUnitNormTolerance))) {
    result.status = PoseStatus::not_a_rotation;
    return result;
  }
  const Eigen::Matrix<Scalar, 4, 1> q = quaternion_wxyz / norm;
  result.pose = {Eigen::Quaternion<Scalar>(q[0], q[1], q[2], q[3]).toRotationMatrix(), position_m};
  return result;
}

/// Smallest height of the triangle whose corners are the columns of `points_m`: 0 for points on a
/// line, NaN if the numbers are not finite or too large to multiply. Metres.
template <class Scalar>
Scalar smallest_height_m(const Matrix3<Scalar>& points_m) {
  const Vector3<Scalar> a = points_m.col(1) - points_m.col(0);
  const Vector3<Scalar> b = points_m.col(2) - points_m.col(0);
  const Scalar longest_m = std::max({a.norm(), b.norm(), (b - a).norm()});
  if (longest_m == 0) return 0;
  return a.cross(b).norm() / longest_m;  // twice the area over the longest side
}

/// Distances of the columns of `points_m`, each entry that of the two points other than its own
/// (m).
template <class Scalar>
Vector3<Scalar> distances_of(const Matrix3<Scalar>& points_m) {
  return {(points_m.col(1) - points_m.col(2)).norm(), (points_m.col(2) - points_m.col(0)).norm(),
          (points_m.col(0) - points_m.col(1)).norm()};
}

/// Three points that keep their distances.
template <class Scalar>
class RigidBody {
 public:
  /// `shape_m`: its columns are the three points in the jaw frame, or in any other frame fixed to
  /// the jaw, which then replaces it. Metres. An unusable shape sets `status`.
  explicit RigidBody(const Matrix3<Scalar>& shape_m)
      : shape_m_(shape_m), status_(judge(shape_m, Scalar(kSmallestHeight_m))) {}

  /// The body with the `distances_m` of `distances_of`, in the jaw frame. Unusable distances set
  /// `status`.
  static RigidBody from_distances(const Vector3<Scalar>& distances_m) {
    const Scalar a = distances_m[0], b = distances_m[1], c = distances_m[2];
    // Distance to the foot of the height; if points 2 and 3 coincide, there is no height.
    const Scalar from_third = a > 0 ? (a * a + b * b - c * c) / (2 * a) : Scalar(0);
    const Scalar height = std::sqrt(std::max(b * b - from_third * from_third, Scalar(0)));
    const Scalar x3 = -from_third, x2 = a - from_third;
    Matrix3<Scalar> shape_m;
    shape_m << 0, x2, x3, 0, 0, 0, 0, height, height;
    return RigidBody(shape_m);
  }

  /// ok; missing if a coordinate of the shape is not finite; degenerate if its smallest height is
  /// below kSmallestHeight_m.
  PoseStatus status() const { return status_; }

  /// The three points in the jaw frame, one a column, metres. Valid if `status` is ok.
  const Matrix3<Scalar>& shape_m() const { return shape_m_; }

  /// The pose that brings the body's points closest to the columns of `points_m` (instrument's
  /// frame, metres). Status: the body's own if that is not ok; missing if a coordinate is not
  /// finite; degenerate if the points are nearly on a line; not_rigid if the residual exceeds
  /// `tolerance_m`.
  PoseFit<Scalar> fit(const Matrix3<Scalar>& points_m,
                      Scalar tolerance_m = Scalar(kRigidTolerance_m)) const {
    PoseFit<Scalar> result;
    result.status = status_;
    if (result.status != PoseStatus::ok) return result;
    // Half, so that noise does not make an accepted shape degenerate.
    result.status = judge(points_m, Scalar(kSmallestHeight_m / 2));
    if (result.status != PoseStatus::ok) return result;
    const auto moved = closest_rigid_motion(shape_m_, points_m);
    result.pose = {moved.template topLeftCorner<3, 3>(), moved.template topRightCorner<3, 1>()};
    Scalar sum_m2 = 0;
    for (int i = 0; i < 3; ++i) {
      sum_m2 += (point_of(result.pose, shape_m_.col(i)) - points_m.col(i)).squaredNorm();
    }
    result.residual_rms_m = std::sqrt(sum_m2 / 3);
    if (!(result.residual_rms_m <= tolerance_m)) result.status = PoseStatus::not_rigid;
    return result;
  }

 private:
  static PoseStatus judge(const Matrix3<Scalar>& points_m, Scalar smallest_m) {
    if (!points_m.allFinite()) return PoseStatus::missing;
    const Scalar height_m = smallest_height_m(points_m);
    if (!(height_m >= smallest_m) || !std::isfinite(height_m)) return PoseStatus::degenerate;
    return PoseStatus::ok;
  }

  Matrix3<Scalar> shape_m_;
  PoseStatus status_;
};

/// Standard deviation, axis by axis (m), of a point that is `lever_m` away from the point that the
/// instrument measures best; `lever_m` in the instrument's frame, as the jaw is now.
/// `position_sd_m` is that point's along each axis, `rotation_sd_rad` the orientation's about each
/// axis, all six independent. To first order a small rotation e moves the point by e x r:
///   e x r = (e_y r_z - e_z r_y, e_z r_x - e_x r_z, e_x r_y - e_y r_x)
///   var_i = position_sd^2 + rotation_sd^2 (|r|^2 - r_i^2)
template <class Scalar>
Vector3<Scalar> point_noise_sd_m(std::type_identity_t<Scalar> position_sd_m,
                                 std::type_identity_t<Scalar> rotation_sd_rad,
                                 const Vector3<Scalar>& lever_m) {
  Vector3<Scalar> sd_m;
  for (int i = 0; i < 3; ++i) {
    const Scalar a_m = lever_m[(i + 1) % 3], b_m = lever_m[(i + 2) % 3];
    sd_m[i] = std::sqrt(position_sd_m * position_sd_m +
                        rotation_sd_rad * rotation_sd_rad * (a_m * a_m + b_m * b_m));
  }
  return sd_m;
}

}  // namespace condyle
