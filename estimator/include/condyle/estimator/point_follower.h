// SPDX-License-Identifier: Apache-2.0
// Follows one point through a run: a point of the instrument, or any point fixed to the jaw
// (incisor, condyle) through the jaw's pose. Model and frames: rigid_body.h.
//
//   kind           point of the instrument      point fixed to the jaw
//   one_axis       unavailable                  unavailable
//   one_point      point 1                      unavailable
//   three_points   points 1 to 3, as they are   fit of the body, b in the jaw frame
//   pose           point 1: its position        b in the pose's own frame
//
// The body's shape is given, or learned: from the first sample whose points make a body. Should the
// next one not fit, that shape was a bad sample's, and the next one's takes its place; two that
// agree settle it for the run. What both have wrong is not noticed: give the shape where it is
// known.
#pragma once

#include <optional>

#include "condyle/estimator/rigid_body.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// The point to follow.
struct FollowedPoint {
  int point = 1;  ///< of the instrument, 1 to 3; not used where `body_point_m` is set
  /// Fixed to the jaw: in the jaw frame, or in the pose's own frame for SampleKind::pose (m).
  std::optional<Eigen::Vector3d> body_point_m;
};

/// True where samples of `kind` can have the followed point.
constexpr bool is_available(SampleKind kind, const FollowedPoint& followed) {
  if (kind == SampleKind::one_axis) return false;
  if (followed.body_point_m) return kind != SampleKind::one_point;
  return is_available(kind, FollowedCoordinate{followed.point, Axis::x});
}

/// Points 1, 2, 3 of a sample of kind three_points, one a column (m).
inline Eigen::Matrix3d points_of(const Sample& sample) {
  return Eigen::Map<const Eigen::Matrix3d>(sample.coordinates);
}

/// Where the followed point is.
struct FollowedPosition {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< instrument's frame; where status is ok
  double residual_rms_m = 0;                             ///< of the body's fit; 0 without one
  PoseStatus status = PoseStatus::ok;
};

/// Takes samples, gives the followed point's position. It remembers the body's shape, nothing else.
class PointFollower {
 public:
  /// Learns the body's shape. `tolerance_m`: residual beyond which a sample is not_rigid.
  explicit PointFollower(const FollowedPoint& followed, double tolerance_m = kRigidTolerance_m)
      : followed_(followed), tolerance_m_(tolerance_m) {}

  /// Follows a point of the known `body`.
  PointFollower(const FollowedPoint& followed, const RigidBody& body,
                double tolerance_m = kRigidTolerance_m)
      : followed_(followed), tolerance_m_(tolerance_m), body_(body), is_settled_(true) {}

  /// The followed point in `sample`, or why it is not there; see PoseStatus.
  FollowedPosition follow(const Sample& sample) {
    if (!is_available(sample.kind, followed_)) return {.status = PoseStatus::unavailable};
    if (!sample.position_valid) return {.status = PoseStatus::missing};
    if (!followed_.body_point_m) return instrument_point(sample);
    const PoseFit fit = pose_of(sample);
    if (fit.status != PoseStatus::ok) {
      return {.residual_rms_m = fit.residual_rms_m, .status = fit.status};
    }
    return {point_of(fit.pose, *followed_.body_point_m), fit.residual_rms_m, PoseStatus::ok};
  }

  /// The body whose points the samples hold; none before a sample made one.
  const std::optional<RigidBody>& body() const { return body_; }

 private:
  FollowedPosition instrument_point(const Sample& sample) const {
    FollowedPosition result;
    for (int i = 0; i < 3; ++i) {
      result.position_m[i] = followed_position_m(sample, {followed_.point, static_cast<Axis>(i)});
    }
    if (!result.position_m.allFinite()) result.status = PoseStatus::missing;
    return result;
  }

  PoseFit pose_of(const Sample& sample) {
    const double* c = sample.coordinates;
    if (sample.kind == SampleKind::pose) {
      return pose_from_quaternion({c[0], c[1], c[2]}, {c[3], c[4], c[5], c[6]});
    }
    const Eigen::Matrix3d points_m = points_of(sample);
    if (!body_) {
      const RigidBody learned = RigidBody::from_points(points_m);
      if (learned.status() != PoseStatus::ok) return {.status = learned.status()};
      body_ = learned;
      return learned.fit(points_m, tolerance_m_);
    }
    const PoseFit fit = body_->fit(points_m, tolerance_m_);
    if (is_settled_) return fit;
    if (fit.status == PoseStatus::ok) is_settled_ = true;
    if (fit.status == PoseStatus::not_rigid) {
      const RigidBody learned = RigidBody::from_points(points_m);
      if (learned.status() == PoseStatus::ok) body_ = learned;
    }
    return fit;
  }

  FollowedPoint followed_;
  double tolerance_m_;
  std::optional<RigidBody> body_;
  bool is_settled_ = false;  // a second sample has fitted the shape
};

}  // namespace condyle
