// SPDX-License-Identifier: Apache-2.0
// The jaw's pose of each sample. Model and frames: rigid_body.h.
//
//   kind           pose
//   three_points   fit of the body
//   pose           the sample's own
//
// The body's shape is given, or learned from the first samples that agree on it (body_shape.h),
// which are withheld until then as `unsettled`. After that the shape is fixed: samples that do not
// fit it are `not_rigid`, for the rest of the run if necessary.
#pragma once

#include <optional>

#include "condyle/estimator/pose/body_shape.h"
#include "condyle/estimator/pose/rigid_body.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// Points 1, 2, 3 of a sample of kind three_points, one a column (m).
template <class Scalar>
Matrix3<Scalar> points_of(const Sample& sample) {
  return Eigen::Map<const Eigen::Matrix3d>(sample.coordinates).template cast<Scalar>();
}

/// Computes the pose from samples. Its only state is the body's shape.
template <class Scalar>
class PoseFollower {
 public:
  /// Learns the body's shape. `largest_tolerance_m`: residual beyond which a sample is not_rigid,
  /// however noisy the points are.
  explicit PoseFollower(Scalar largest_tolerance_m = Scalar(kRigidTolerance_m))
      : shape_(largest_tolerance_m) {}

  /// Knows the `body`. `tolerance_m`: residual beyond which a sample is not_rigid.
  explicit PoseFollower(const RigidBody<Scalar>& body,
                        Scalar tolerance_m = Scalar(kRigidTolerance_m))
      : shape_(tolerance_m), tolerance_m_(tolerance_m), body_(body) {}

  /// The pose in `sample`, or why there is none; see PoseStatus.
  PoseFit<Scalar> follow(const Sample& sample) {
    PoseFit<Scalar> none;
    if (sample.kind != SampleKind::pose && sample.kind != SampleKind::three_points) {
      none.status = PoseStatus::unavailable;
      return none;
    }
    if (!sample.position_valid) {
      none.status = PoseStatus::missing;
      return none;
    }
    if (sample.kind == SampleKind::three_points) {
      return of_points(points_of<Scalar>(sample));
    }
    const Eigen::Map<const Eigen::Matrix<double, 7, 1>> values(sample.coordinates);
    return pose_from_quaternion<Scalar>(values.template head<3>().template cast<Scalar>(),
                                        values.template tail<4>().template cast<Scalar>());
  }

  /// The body of the three points; none until its shape is settled.
  const std::optional<RigidBody<Scalar>>& body() const { return body_; }
  /// Residual beyond which a sample is not_rigid (m); 0 until the shape is settled.
  Scalar tolerance_m() const { return tolerance_m_; }

 private:
  PoseFit<Scalar> of_points(const Matrix3<Scalar>& points_m) {
    if (body_) return body_->fit(points_m, tolerance_m_);
    PoseFit<Scalar> none;
    none.status = RigidBody<Scalar>(points_m).status();
    if (none.status != PoseStatus::ok) return none;
    shape_.add(points_m);
    none.status = shape_.has_seen_enough() ? PoseStatus::not_rigid : PoseStatus::unsettled;
    if (!shape_.is_settled()) return none;
    body_ = shape_.body();
    tolerance_m_ = shape_.tolerance_m();
    return body_->fit(points_m, tolerance_m_);
  }

  BodyShape<Scalar> shape_;
  Scalar tolerance_m_ = 0;
  std::optional<RigidBody<Scalar>> body_;
};

}  // namespace condyle
