// SPDX-License-Identifier: Apache-2.0
#include "readings/pointer.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "condyle/estimator/pose/rigid_body.h"
#include "condyle/estimator/pose/rotation_vector.h"
#include "hosted/files/input_error.h"
#include "readings/pose_noise.h"

namespace condyle::host {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kLeastPoses = 30;
constexpr double kMostResidual_m = 2e-3, kMostTipSd_m = 2e-3;
constexpr double kMostCorrelation = 0.99;

// Correlation of neighbours, at least 0.
double correlation_of(const std::vector<Vector3d>& residuals_m) {
  double products = 0, squares = 0;
  for (std::size_t k = 1; k < residuals_m.size(); ++k) {
    products += residuals_m[k].dot(residuals_m[k - 1]);
    squares += residuals_m[k].squaredNorm();
  }
  return squares > 0 ? std::clamp(products / squares, 0.0, kMostCorrelation) : 0;
}

double rotation_noise_rad(const std::vector<double>& time_s, const std::vector<Isometry3d>& poses) {
  PoseTrack track;
  track.time_s = time_s;
  track.pose = poses;
  const PoseNoise noise = noise_of(motion_from(track, 0, 1, MovingBody::lower), 0, 0);
  return std::sqrt(noise.covariance.bottomRightCorner<3, 3>().trace() / 3);
}

}  // namespace

PointerTip calibrate_tip(const std::vector<double>& time_s, const std::vector<Isometry3d>& poses,
                         const std::string& place) {
  if (poses.size() < kLeastPoses) {
    throw InputError(place, fmt::format("the pointer has {} usable samples there", poses.size()),
                     fmt::format("give an interval with {} or more", kLeastPoses));
  }
  const auto count = static_cast<double>(poses.size());
  Matrix3d mean = Matrix3d::Zero();
  Vector3d middle_m = Vector3d::Zero();
  for (const Isometry3d& pose : poses) {
    mean += pose.linear() / count;
    middle_m += pose.translation() / count;
  }
  Matrix3d S = Matrix3d::Zero();
  Vector3d right_m = Vector3d::Zero();
  PointerTip result;
  const Isometry3d mean_of_all = mean_pose(poses, 0, poses.size());
  for (const Isometry3d& pose : poses) {
    const Matrix3d turned = pose.linear() - mean;
    S += turned.transpose() * turned;
    right_m -= turned.transpose() * (pose.translation() - middle_m);
    result.turn_rad = std::max(
        result.turn_rad,
        rotation_vector_of<double>(pose.linear() * mean_of_all.linear().transpose()).norm());
  }
  const double least = Eigen::SelfAdjointEigenSolver<Matrix3d>(S).eigenvalues()[0];
  if (!(least > count * kLeastPivotTurn * kLeastPivotTurn)) {
    throw InputError(place,
                     fmt::format("the pointer turns by at most {:.0f} deg, or about one axis only, "
                                 "which does not show where its tip is",
                                 result.turn_rad * 180 / std::numbers::pi),
                     "hold the tip in a hole and tilt the pointer by 30 deg to all sides");
  }
  result.tip_m = S.ldlt().solve(right_m);
  const Vector3d hole_m = mean * result.tip_m + middle_m;
  std::vector<Vector3d> residuals_m;
  double sum_m2 = 0;
  for (const Isometry3d& pose : poses) {
    residuals_m.emplace_back(pose * result.tip_m - hole_m);
    sum_m2 += residuals_m.back().squaredNorm();
  }
  result.residual_rms_m = std::sqrt(sum_m2 / count);
  if (result.residual_rms_m > kMostResidual_m) {
    throw InputError(place,
                     fmt::format("the tip does not stay in one place (it misfits by {:.1f} mm)",
                                 result.residual_rms_m * 1e3),
                     "give the interval in which the tip rests in the hole");
  }
  const double q = correlation_of(residuals_m);
  const double variance_m2 = sum_m2 / (3 * count - 6) * (1 + q) / (1 - q) / least;
  const double noise_rad = rotation_noise_rad(time_s, poses);
  result.sd_m = std::hypot(std::sqrt(variance_m2),
                           2 * noise_rad * noise_rad * result.tip_m.norm() * count / least);
  if (result.sd_m > kMostTipSd_m) {
    throw InputError(place,
                     fmt::format("the tip is known to {:.1f} mm (sd) only", result.sd_m * 1e3),
                     "calibrate for longer, and tilt the pointer farther to all sides");
  }
  return result;
}

Isometry3d three_point_frame(const PointColumns& shape_m, const std::string& place) {
  const Matrix3d points_m = shape_m.leftCols<3>();
  const auto frame = RigidBody<double>::from_distances(distances_of(points_m));
  const PoseFit<double> fit = frame.fit(points_m);
  if (fit.status != PoseStatus::ok) {
    throw InputError(place, "the first three points lie on a line or coincide",
                     "name three points first that span a triangle: they define the tip's frame");
  }
  Isometry3d pose;
  pose.linear() = fit.pose.rotation;
  pose.translation() = fit.pose.translation;
  return pose;
}

}  // namespace condyle::host
