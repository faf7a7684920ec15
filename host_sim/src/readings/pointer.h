// SPDX-License-Identifier: Apache-2.0
// A pointer: a rigid body with a tip. Pivot calibration finds the tip while it rests in a hole and
// the pointer turns about it.
//
//   R_k, t_k   poses of the pointer; x   tip in its frame; c   the hole
//   minimised  sum |R_k x + t_k - c|^2:  S x = -sum (R_k - R)' t_k,  S = sum (R_k - R)'(R_k - R)
//   variance   s^2 S^-1, s^2 = sum |residual|^2 / (3 n - 6), times (1 + q)/(1 - q) for residuals
//              whose neighbours correlate by q; plus the square of 2 r^2 |x| n / lambda, by which
//              noise r of the rotation (rad) pulls the tip towards the points; lambda: the least
//              eigenvalue of S
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "readings/point_body.h"

namespace condyle::host {

/// The tip of a pointer in the frame of its body (PointBody), m.
struct PointerTip {
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  double sd_m = 0;            ///< along the axis where it is greatest
  double residual_rms_m = 0;  ///< of the calibration
  double turn_rad = 0;        ///< greatest rotation from the mean pose
};

/// Least root mean square change of a direction of the pointer (rad), to calibrate its tip.
inline constexpr double kLeastPivotTurn = 0.1;

/// The tip from `poses` at rising `time_s`. Throws an InputError that names `place` if the pointer
/// turns too little to know it, or if the tip slides.
PointerTip calibrate_tip(const std::vector<double>& time_s,
                         const std::vector<Eigen::Isometry3d>& poses, const std::string& place);

/// The frame of the first three points of a body (condyle/estimator/pose/rigid_body.h), as its pose
/// in the frame of `shape_m`. Throws an InputError that names `place` if they lie on a line.
Eigen::Isometry3d three_point_frame(const PointColumns& shape_m, const std::string& place);

}  // namespace condyle::host
