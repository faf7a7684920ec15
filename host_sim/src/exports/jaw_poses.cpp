// SPDX-License-Identifier: Apache-2.0
#include "exports/jaw_poses.h"

#include <algorithm>

#include "condyle/estimator/pose/point_follower.h"
#include "condyle/estimator/pose/rigid_body.h"
#include "readings/pose_track.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

std::optional<JawPoses> measured_poses(const ExportSeries& places, const ExportSeries& turns,
                                       std::size_t samples) {
  JawPoses poses{.provenance = turns.provenance, .assumption = turns.assumption, .of_sample = {}};
  for (std::size_t k = 0; k < samples; ++k) {
    if (!places.is_there(k) || !turns.is_there(k)) {
      poses.of_sample.emplace_back();
      continue;
    }
    ExportPose& pose = poses.of_sample.emplace_back(ExportPose{}).value();
    std::copy_n(places.at(k), 3, pose.position_m);
    std::copy_n(turns.at(k), 4, pose.orientation);
  }
  return poses;
}

std::optional<JawPoses> fitted_poses(const std::vector<const ExportSeries*>& points,
                                     std::size_t samples) {
  std::vector<std::optional<Eigen::Matrix3d>> triangles;
  std::vector<double> distances_m[3];
  for (std::size_t k = 0; k < samples; ++k) {
    Eigen::Matrix3d places;
    for (int i = 0; i < 3; ++i) {
      places.col(i) = Eigen::Vector3d(points[static_cast<std::size_t>(i)]->at(k));
    }
    triangles.push_back(places.allFinite() ? std::optional(places) : std::nullopt);
    if (!places.allFinite()) continue;
    const Eigen::Vector3d distances = distances_of(places);
    for (int i = 0; i < 3; ++i) distances_m[i].push_back(distances[i]);
  }
  if (distances_m[0].empty()) return std::nullopt;
  Eigen::Vector3d medians_m;
  for (int i = 0; i < 3; ++i) medians_m[i] = upper_median(std::move(distances_m[i]));
  const auto body = RigidBody<double>::from_distances(medians_m);
  if (body.status() != PoseStatus::ok) return std::nullopt;
  std::vector<double> residuals_m;
  std::vector<std::optional<PoseFit<double>>> fits;
  for (const auto& triangle : triangles) {
    fits.push_back(triangle ? std::optional(body.fit(*triangle)) : std::nullopt);
    if (triangle) residuals_m.push_back(fits.back()->residual_rms_m);
  }
  const double tolerance_m = residual_tolerance_m(residuals_m);
  JawPoses poses{.provenance = Provenance::derived,
                 .assumption = "the three points are one rigid body of their median distances",
                 .of_sample = {}};
  for (const auto& fit : fits) {
    if (!fit || fit->status != PoseStatus::ok || fit->residual_rms_m > tolerance_m) {
      poses.of_sample.emplace_back();
      continue;
    }
    ExportPose& pose = poses.of_sample.emplace_back(ExportPose{}).value();
    const Eigen::Quaterniond turn(fit->pose.rotation);
    for (int i = 0; i < 3; ++i) pose.position_m[i] = fit->pose.translation[i];
    const double wxyz[] = {turn.w(), turn.x(), turn.y(), turn.z()};
    std::copy_n(wxyz, 4, pose.orientation);
  }
  return poses;
}

}  // namespace

std::optional<JawPoses> jaw_poses(const ExportData& data) {
  auto points = data.points();
  points.erase(std::remove_if(points.begin(), points.end(),
                              [](const ExportSeries* point) { return point->is_computed; }),
               points.end());
  for (const ExportSeries& turns : data.series) {
    if (turns.is_computed || turns.quantity != "orientation") continue;
    for (const ExportSeries* places : points) {
      if (places->name == turns.name) return measured_poses(*places, turns, data.samples());
    }
  }
  if (points.size() != 3) return std::nullopt;
  return fitted_poses(points, data.samples());
}

}  // namespace condyle::host
