// SPDX-License-Identifier: Apache-2.0
// A jaw whose condyles follow given paths: its pose is a known smooth function of time.
//
//   L, R   condylar points; x, z of both on their fossae; y of the orbiting one from its path (of
//          none in symmetrical motion: midway), y of the other from the constant |L - R|
//   u      (L - R)/|L - R|
//   pose   rotation Rot(u, opening angle) * (smallest rotation that turns Y into u), midpoint of L,
//   R
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/kinematic/jaw_motion.h"
#include "simulation/kinematic/jaw_scenario.h"

namespace condyle::host {

/// Pose of the jaw in the head frame A: a point b (A, at the reference position) is at R b + t.
struct JawPose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
};

/// Points at the reference position (m).
struct JawLandmarks {
  Eigen::Vector3d condyle_left, condyle_right, incisor_lower, plane_left, plane_right, plane_front;
};

class KinematicJaw {
 public:
  /// Throws InputError if a condyle would pass the lowest point of its fossa, or move too far.
  explicit KinematicJaw(const JawScenario& scenario);

  /// In the head frame A, at any time.
  JawPose pose_at(double time_s) const;
  const JawMotionPlan& motion() const { return motion_; }
  const JawScenario& scenario() const { return scenario_; }
  /// In the head frame A.
  const JawLandmarks& landmarks() const { return landmarks_; }
  /// Rotation from the frame of the fossae to A.
  const Eigen::Matrix3d& head_from_fossae() const { return head_from_fossae_; }

 private:
  // A condylar path in metres.
  struct Path {
    double slope, orbiting_slope, curvature_per_m, immediate_shift_m, progressive_slope;
    explicit Path(const CondylarPath& path);
    double z_m(double x_m, bool orbits) const {
      return -((orbits ? orbiting_slope : slope) - curvature_per_m * x_m) * x_m;
    }
    double medial_m(double x_m) const;
  };

  void check_advance() const;

  JawScenario scenario_;
  JawMotionPlan motion_;
  Path left_, right_;
  JawLandmarks landmarks_;
  Eigen::Matrix3d head_from_fossae_;
};

}  // namespace condyle::host
