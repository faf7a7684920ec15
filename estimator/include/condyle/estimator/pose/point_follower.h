// SPDX-License-Identifier: Apache-2.0
// Follows one point through a run: a point of the instrument, or any point fixed to the jaw
// (incisor, condyle) through the jaw's pose. Model and frames: rigid_body.h.
//
//   kind           point of the instrument      point fixed to the jaw
//   one_axis       unavailable                  unavailable
//   one_point      point 1                      unavailable
//   three_points   points 1 to 3, as they are   b in the jaw frame (pose_follower.h)
//   pose           point 1: its position        b in the pose's own frame
#pragma once

#include <cstdint>
#include <optional>

#include "condyle/estimator/pose/pose_follower.h"

namespace condyle {

/// Results of the fits of three points to a body so far.
struct BodyFits {
  std::uint64_t fitted = 0;
  std::uint64_t unsettled = 0;        ///< samples withheld while the shape was learned
  std::uint64_t degenerate = 0;       ///< samples whose points coincide or lie on a line
  std::uint64_t not_rigid = 0;        ///< samples with a larger residual than the tolerance
  double residual_square_sum_m2 = 0;  ///< of those fitted
  double tolerance_m = 0;             ///< 0 until the shape is settled
};

/// The point to follow.
struct FollowedPoint {
  int point = 1;  ///< of the instrument, 1 to 3; not used if `body_point_m` is set
  /// Fixed to the jaw: in the jaw frame, or in the pose's own frame for SampleKind::pose (m).
  std::optional<Eigen::Vector3d> body_point_m = {};
  /// Updated with each sample of three_points; may be null. Must outlive the follower.
  BodyFits* fits = nullptr;
};

/// True if samples of `kind` can have the followed point.
constexpr bool is_available(SampleKind kind, const FollowedPoint& followed) {
  if (kind == SampleKind::one_axis) return false;
  if (followed.body_point_m) return kind != SampleKind::one_point;
  return is_available(kind, FollowedCoordinate{followed.point, Axis::x});
}

/// Place of the followed point.
struct FollowedPosition {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< instrument's frame; valid if ok
  /// Vector to the followed point (m) from the point that the instrument measures best, which is
  /// the middle of its three points or the pose's origin; 0 for a point of the instrument.
  Eigen::Vector3d lever_m = Eigen::Vector3d::Zero();
  double residual_rms_m = 0;  ///< of the body's fit; 0 without one
  PoseStatus status = PoseStatus::ok;
};

/// Computes the followed point's position from samples. Its only state is the body's shape.
template <class Scalar>
class PointFollower {
 public:
  /// Learns the body's shape. `largest_tolerance_m`: residual beyond which a sample is not_rigid,
  /// however noisy the points are.
  explicit PointFollower(const FollowedPoint& followed,
                         Scalar largest_tolerance_m = Scalar(kRigidTolerance_m))
      : followed_(followed), pose_(largest_tolerance_m) {}

  /// Follows a point of the known `body`. `tolerance_m`: residual beyond which a sample is
  /// not_rigid.
  PointFollower(const FollowedPoint& followed, const RigidBody<Scalar>& body,
                Scalar tolerance_m = Scalar(kRigidTolerance_m))
      : followed_(followed), pose_(body, tolerance_m) {}

  /// The followed point in `sample`, or why there is none; see PoseStatus.
  FollowedPosition follow(const Sample& sample) {
    if (!is_available(sample.kind, followed_)) return {.status = PoseStatus::unavailable};
    if (!sample.position_valid) return {.status = PoseStatus::missing};
    if (!followed_.body_point_m) return instrument_point(sample);
    const PoseFit<Scalar> fit = pose_.follow(sample);
    if (followed_.fits != nullptr && sample.kind == SampleKind::three_points) {
      count(fit, *followed_.fits);
    }
    if (fit.status != PoseStatus::ok) {
      return {.residual_rms_m = fit.residual_rms_m, .status = fit.status};
    }
    const Vector3<Scalar> position_m =
        point_of(fit.pose, followed_.body_point_m->template cast<Scalar>());
    const Vector3<Scalar> best_m =
        sample.kind == SampleKind::pose
            ? fit.pose.translation
            : Vector3<Scalar>(points_of<Scalar>(sample).rowwise().mean());
    return {position_m.template cast<double>(), (position_m - best_m).template cast<double>(),
            fit.residual_rms_m, PoseStatus::ok};
  }

  /// The body of the three points; none until its shape is settled.
  const std::optional<RigidBody<Scalar>>& body() const { return pose_.body(); }

 private:
  FollowedPosition instrument_point(const Sample& sample) const {
    FollowedPosition result;
    for (int i = 0; i < 3; ++i) {
      result.position_m[i] = followed_position_m(sample, {followed_.point, static_cast<Axis>(i)});
    }
    if (!result.position_m.allFinite()) result.status = PoseStatus::missing;
    return result;
  }

  void count(const PoseFit<Scalar>& fit, BodyFits& fits) const {
    fits.fitted += fit.status == PoseStatus::ok ? 1U : 0U;
    fits.unsettled += fit.status == PoseStatus::unsettled ? 1U : 0U;
    fits.degenerate += fit.status == PoseStatus::degenerate ? 1U : 0U;
    fits.not_rigid += fit.status == PoseStatus::not_rigid ? 1U : 0U;
    if (fit.status != PoseStatus::ok) return;
    const double residual_rms_m = fit.residual_rms_m;
    fits.residual_square_sum_m2 += residual_rms_m * residual_rms_m;
    fits.tolerance_m = pose_.tolerance_m();
  }

  FollowedPoint followed_;
  PoseFollower<Scalar> pose_;
};

}  // namespace condyle
