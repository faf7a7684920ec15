// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/kinematic_jaw.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "condyle/estimator/math/elementary.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kImmediateWay_m = 0.4e-3;  // of advance, in which the immediate shift happens

double tangent(double angle_deg) {
  const double angle_rad = angle_deg * (std::numbers::pi / 180);
  return elementary::sin(angle_rad) / elementary::cos(angle_rad);
}

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d result;
  result << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return result;
}

// About the unit vector `axis`.
Matrix3d rotation_about(const Vector3d& axis, double angle_rad) {
  const Matrix3d across = cross_matrix(axis);
  return Matrix3d::Identity() + elementary::sin(angle_rad) * across +
         (1 - elementary::cos(angle_rad)) * across * across;
}

// The smallest rotation that turns Y into the unit vector `to`, which is not near -Y.
Matrix3d rotation_from_y(const Vector3d& to) {
  const Matrix3d across = cross_matrix(Vector3d::UnitY().cross(to));
  return Matrix3d::Identity() + across + across * across / (1 + to.y());
}

}  // namespace

KinematicJaw::Path::Path(const CondylarPath& path)
    : slope(tangent(path.inclination_deg)),
      orbiting_slope(tangent(path.inclination_deg + path.fischer_deg)),
      curvature_per_m(path.curvature_per_mm * 1e3),
      immediate_shift_m(path.immediate_shift_mm * 1e-3),
      progressive_slope(tangent(path.progressive_shift_deg)) {}

double KinematicJaw::Path::medial_m(double x_m) const {
  return immediate_shift_m * (1 - elementary::exp(-x_m / kImmediateWay_m)) +
         progressive_slope * x_m;
}

KinematicJaw::KinematicJaw(const JawScenario& scenario)
    : scenario_(scenario),
      motion_(scenario),
      left_(scenario.anatomy.left),
      right_(scenario.anatomy.right) {
  check_advance();
  const JawAnatomy& jaw = scenario.anatomy;
  head_from_fossae_ =
      rotation_about(Vector3d::UnitY(), -jaw.plane_tilt_deg * (std::numbers::pi / 180));
  landmarks_.condyle_left = 1e-3 * Vector3d(0, jaw.half_width_mm, 0);
  landmarks_.condyle_right = 1e-3 * Vector3d(0, -jaw.half_width_mm, 0);
  landmarks_.incisor_lower =
      head_from_fossae_ * (1e-3 * Vector3d(jaw.incisor_x_mm, 0, jaw.incisor_z_mm));
  landmarks_.plane_left = 1e-3 * Vector3d(jaw.plane_back_x_mm, jaw.plane_back_y_mm, 0);
  landmarks_.plane_right = 1e-3 * Vector3d(jaw.plane_back_x_mm, -jaw.plane_back_y_mm, 0);
  landmarks_.plane_front = 1e-3 * Vector3d(jaw.plane_front_x_mm, jaw.plane_front_y_mm, 0);
}

void KinematicJaw::check_advance() const {
  const double advance_m = motion_.greatest_advance_m();
  for (const Path& path : {left_, right_}) {
    const double least_slope = std::min(path.slope, path.orbiting_slope);
    if (least_slope < 2 * path.curvature_per_m * advance_m) {
      throw InputError(
          scenario_.name,
          fmt::format("a condyle advances {:.1f} mm, but its path is lowest after {:.1f} mm",
                      advance_m * 1e3, least_slope / path.curvature_per_m / 2 * 1e3),
          "reduce advance_mm or its spread, or make the path less curved");
    }
    if (advance_m - path.z_m(advance_m, path.orbiting_slope > path.slope) >
        scenario_.anatomy.half_width_mm * 1e-3) {
      throw InputError(scenario_.name, "a condyle moves further than it is from the midline",
                       "reduce advance_mm, its spread or inclination_deg");
    }
  }
}

JawPose KinematicJaw::pose_at(double time_s) const {
  const JawCoordinates q = motion_.at(time_s);
  const double half_width_m = scenario_.anatomy.half_width_mm * 1e-3;
  Vector3d left(q.left_m, 0, left_.z_m(q.left_m, q.orbiting == JawSide::left));
  Vector3d right(q.right_m, 0, right_.z_m(q.right_m, q.orbiting == JawSide::right));
  const double width_m = std::sqrt(4 * half_width_m * half_width_m - (left - right).squaredNorm());
  switch (q.orbiting) {
    case JawSide::none:
      left.y() = width_m / 2;
      right.y() = -width_m / 2;
      break;
    case JawSide::left:
      left.y() = half_width_m - left_.medial_m(q.lateral_m);
      right.y() = left.y() - width_m;
      break;
    case JawSide::right:
      right.y() = right_.medial_m(q.lateral_m) - half_width_m;
      left.y() = right.y() + width_m;
      break;
  }
  const Vector3d axis = (left - right) / (2 * half_width_m);
  const Matrix3d rotation = rotation_about(axis, q.opening_rad) * rotation_from_y(axis);
  return {head_from_fossae_ * rotation * head_from_fossae_.transpose(),
          head_from_fossae_ * ((left + right) / 2)};
}

}  // namespace condyle::host
