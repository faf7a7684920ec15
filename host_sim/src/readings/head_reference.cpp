// SPDX-License-Identifier: Apache-2.0
#include "readings/head_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kMostMisfit_m = 1e-3;      // of stated points and the tracked body
constexpr double kMostHeadMotion_m = 5e-3;  // of a landmark, in the reference position
constexpr double kNotedHeadMotion_m = 5e-4;
constexpr double kMostJawDistance_m = 3e-3;  // of the reference positions of both recordings

// The pose of `body` at its stated points. Throws an InputError if they are not the same points.
BodyFit stated_fit(const TrackedBody& body, const StatedBody& stated, const char* key,
                   const std::string& path) {
  PointColumns points_m = PointColumns::Constant(3, body.shape_m.cols(), std::nan(""));
  std::size_t common = 0;
  for (std::size_t i = 0; i < body.names.size(); ++i) {
    const auto found = std::find(stated.names.begin(), stated.names.end(), body.names[i]);
    if (found == stated.names.end()) continue;
    points_m.col(static_cast<Index>(i)) = stated.points_m.col(found - stated.names.begin());
    ++common;
  }
  const BodyFit fit = PointBody(body.shape_m).fit(points_m);
  if (!fit.is_fitted) {
    throw InputError(path,
                     fmt::format("{} has {} of the points {}, which span no triangle", key, common,
                                 fmt::join(body.names, ", ")),
                     "name the same points as when the landmarks were taken");
  }
  if (fit.residual_rms_m > kMostMisfit_m) {
    throw InputError(path,
                     fmt::format("{} misfit the recording's points of these names by {:.1f} mm",
                                 key, fit.residual_rms_m * 1e3),
                     "the markers were moved, or another instrument was used: take the landmarks "
                     "again with condyle landmarks");
  }
  return fit;
}

void widen(Landmarks& landmarks, std::size_t i, double sd_m) {
  landmarks.sd_m[i] = std::hypot(landmarks.sd_m[i], sd_m);
}

}  // namespace

bool place_stated_head(PoseTrack& track, std::optional<Landmarks>& landmarks,
                       const std::string& path, std::vector<std::string>& notes) {
  if (!landmarks || landmarks->head.names.empty()) return false;
  if (track.head_pose.empty()) {
    notes.emplace_back(
        "the landmarks were taken with a tracked head; without --head they hold only if the head "
        "has not moved since");
    return false;
  }
  const BodyFit fit = stated_fit(track.head, landmarks->head, "head_points", path);
  // A misfit turns the head by as much over the size of its points; the landmarks may be farther
  // away than these.
  const double size_m =
      std::sqrt(track.head.shape_m.squaredNorm() / static_cast<double>(track.head.shape_m.cols()));
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    const double lever_m = (landmarks->point_m[i] - fit.pose.translation()).norm();
    widen(*landmarks, i, fit.residual_rms_m * std::hypot(1, lever_m / size_m));
  }
  refer_to_head(track, fit.pose);
  return true;
}

void widen_by_head_motion(const PoseTrack& track, SampleRun rest, Landmarks& landmarks,
                          const std::string& recording, std::vector<std::string>& notes) {
  double greatest_m = 0;
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    // Along each axis.
    const Vector3d at = track.head_at.inverse(Eigen::Isometry) * landmarks.point_m[i];
    double sum_m2 = 0;
    for (std::size_t k = rest.begin; k < rest.end; ++k) {
      sum_m2 += (track.head_pose[k] * at - landmarks.point_m[i]).squaredNorm();
    }
    const double sd_m = std::sqrt(sum_m2 / 3 / static_cast<double>(rest.end - rest.begin));
    widen(landmarks, i, sd_m);
    greatest_m = std::max(greatest_m, sd_m);
  }
  if (greatest_m > kMostHeadMotion_m) {
    throw InputError(
        recording,
        fmt::format("the head moves the landmarks by {:.1f} mm (sd) during the reference position",
                    greatest_m * 1e3),
        "state a rest of the head with --reference-s, or take the landmarks with condyle "
        "landmarks --head, which states where the head was");
  }
  notes.emplace_back(
      "the landmarks do not state where the head was: they are assumed to hold with the head where "
      "it is in the reference position");
  if (greatest_m > kNotedHeadMotion_m) {
    notes.push_back(fmt::format(
        "the head moves during the reference position: the landmarks are uncertain by {:.1f} mm "
        "more (sd)",
        greatest_m * 1e3));
  }
}

void check_stated_jaw(const PoseTrack& track, SampleRun rest, const Landmarks& landmarks,
                      const std::string& path) {
  if (landmarks.jaw.names.empty() || track.jaw.names.empty()) return;
  const BodyFit fit = stated_fit(track.jaw, landmarks.jaw, "jaw_points", path);
  const Isometry3d reference = mean_pose(track.pose, rest.begin, rest.end);
  const double away_m =
      std::sqrt((fit.pose * track.jaw.shape_m - reference * track.jaw.shape_m).squaredNorm() /
                static_cast<double>(track.jaw.shape_m.cols()));
  if (away_m <= kMostJawDistance_m) return;
  throw InputError(path,
                   fmt::format("the jaw's points were {:.1f} mm from where they are in the "
                               "reference position of the recording",
                               away_m * 1e3),
                   track.head_pose.empty()
                       ? "the head or the instrument has moved since: track the head and give "
                         "--head, or take the landmarks again"
                       : "state the rest in intercuspation with --reference-s, or take the "
                         "landmarks again");
}

}  // namespace condyle::host
