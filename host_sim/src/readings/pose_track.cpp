// SPDX-License-Identifier: Apache-2.0
#include "readings/pose_track.h"

#include <fmt/format.h>

#include <algorithm>

#include "condyle/estimator/pose/point_follower.h"
#include "condyle/estimator/pose/rigid_body.h"
#include "condyle/estimator/pose/rotation_vector.h"
#include "hosted/files/input_error.h"
#include "readings/burst_search.h"
#include "readings/number_step.h"
#include "statistics/in_blocks.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Digits of a recording, below which a residual means nothing.
constexpr double kSmallestTolerance_m = 1e-4;
// Of the middle of the points, with 0.1 m times the turning: about twice the fastest chewing.
constexpr double kFastestJaw_m_s = 1;

// Whether a jaw may make the movement of the `run` of samples, which have others on both sides.
bool may_be_of_jaw(const std::vector<double>& time_s, const std::vector<Vector6>& path,
                   const SampleRun& run) {
  for (const std::size_t k : {run.begin, run.end}) {
    if (k == 0 || k >= path.size()) continue;
    const double speed_m_s = (path[k] - path[k - 1]).norm() / (time_s[k] - time_s[k - 1]);
    if (speed_m_s > kFastestJaw_m_s) return false;
  }
  return true;
}

struct ThreePoints {
  double time_s;
  Matrix3d points_m;
};

// Fits the body with the median distances; what does not fit is not used.
void fit_body(const std::vector<ThreePoints>& samples, const std::string& name, PoseTrack& track) {
  Vector3d distances_m;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> all;
    all.reserve(samples.size());
    for (const ThreePoints& sample : samples) all.push_back(distances_of(sample.points_m)[k]);
    distances_m[k] = upper_median(std::move(all));
  }
  const auto in_jaw_frame = RigidBody<double>::from_distances(distances_m);
  if (in_jaw_frame.status() != PoseStatus::ok) {
    throw InputError(name, "its three points lie on a line or coincide",
                     "give three points of one rigid body that span a triangle");
  }
  const Vector3d middle_m = in_jaw_frame.shape_m().rowwise().mean();
  const Matrix3d shape_m = in_jaw_frame.shape_m().colwise() - middle_m;
  track.jaw.shape_m = shape_m;
  const RigidBody<double> body(shape_m);
  track.time_s.reserve(samples.size());
  track.pose.resize(samples.size());
  std::vector<double> residuals_m(samples.size());
  std::vector<char> is_fitted(samples.size());  // not bool: threads write to neighbours
  run_in_blocks(samples.size(), kSamplesInBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const PoseFit<double> fit = body.fit(samples[i].points_m);
      residuals_m[i] = fit.residual_rms_m;
      is_fitted[i] = fit.status == PoseStatus::ok ? 1 : 0;
      track.pose[i].linear() = fit.pose.rotation;
      track.pose[i].translation() = fit.pose.translation;
    }
  });
  const double tolerance_m = residual_tolerance_m(residuals_m);
  track.jaw.residual_m = usual_residual_m(residuals_m);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (is_fitted[i] == 0 || residuals_m[i] > tolerance_m) continue;
    track.pose[track.time_s.size()] = track.pose[i];
    track.time_s.push_back(samples[i].time_s);
  }
  track.pose.resize(track.time_s.size());
  track.counts.not_rigid += samples.size() - track.time_s.size();
}

}  // namespace

double residual_tolerance_m(const std::vector<double>& residuals_m) {
  return std::max(8 * upper_median(residuals_m), kSmallestTolerance_m);
}

double usual_residual_m(std::vector<double> residuals_m) {
  return sorted_at(residuals_m, residuals_m.size() * 9 / 10);
}

void refuse_if_short(std::size_t usable, const PoseCounts& counts, const std::string& name) {
  if (usable >= kLeastSamples) return;
  throw InputError(name, fmt::format("{} of {} samples can be used", usable, counts.samples),
                   fmt::format("at least {} are needed", kLeastSamples));
}

void keep_usable(PoseTrack& track) {
  std::vector<Vector6> path(track.pose.size());
  const Matrix3d back = track.pose[0].linear().transpose();
  run_in_blocks(path.size(), kSamplesInBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Isometry3d& pose = track.pose[i];
      path[i] << pose.translation(),
          kRotationLength_m * rotation_vector_of<double>(pose.linear() * back);
    }
  });
  const std::vector<SampleRun> bursts = find_bursts(track.time_s, path);
  const std::vector<SampleRun> frozen = find_frozen(path);
  std::vector<bool> bad(path.size(), false);
  for (const auto& [runs, count] :
       {std::pair(&bursts, &track.counts.in_bursts), std::pair(&frozen, &track.counts.frozen)}) {
    for (const SampleRun& run : *runs) {
      track.events.push_back(fmt::format(
          "{} samples from {:.2f} to {:.2f} s {}", run.end - run.begin, track.time_s[run.begin],
          track.time_s[run.end - 1],
          runs == &bursts ? "jump away from the path" : "repeat one pose while the jaw moves"));
      const bool is_jump = runs == &bursts && may_be_of_jaw(track.time_s, path, run);
      for (std::size_t i = run.begin; i < run.end; ++i) {
        if (is_jump) track.jumps_s.push_back(track.time_s[i]);
        *count += bad[i] ? 0U : 1U;
        bad[i] = true;
      }
    }
  }
  std::sort(track.jumps_s.begin(), track.jumps_s.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (bad[i]) continue;
    track.time_s[kept] = track.time_s[i];
    if (!track.head_pose.empty()) track.head_pose[kept] = track.head_pose[i];
    track.pose[kept++] = track.pose[i];
  }
  track.time_s.resize(kept);
  track.pose.resize(kept);
  if (!track.head_pose.empty()) track.head_pose.resize(kept);
}

PoseTrack read_poses(Recording& recording, const std::string& name) {
  PoseTrack track;
  std::vector<ThreePoints> points;
  Sample sample;
  double last_s = 0;
  bool has_time = false;
  while (recording.next(sample)) {
    ++track.counts.samples;
    if (sample.kind == SampleKind::one_axis) break;
    if (!sample.time_valid || !sample.position_valid) {
      ++track.counts.missing;
      continue;
    }
    const double time_s = seconds(sample.time_ns);
    if (has_time && time_s <= last_s) {
      ++track.counts.time_reversed;
      continue;
    }
    has_time = true;
    last_s = time_s;
    if (sample.kind == SampleKind::three_points) {
      points.push_back({time_s, points_of<double>(sample)});
      continue;
    }
    Isometry3d pose = Isometry3d::Identity();
    const double* const c = sample.coordinates;
    pose.translation() = Vector3d(c[0], c[1], c[2]);
    if (sample.kind == SampleKind::pose) {
      const auto fit = pose_from_quaternion<double>(Vector3d(c[0], c[1], c[2]),
                                                    Eigen::Vector4d(c[3], c[4], c[5], c[6]));
      if (fit.status != PoseStatus::ok) {
        ++track.counts.not_rigid;
        continue;
      }
      pose.linear() = fit.pose.rotation;
    }
    track.time_s.push_back(time_s);
    track.pose.push_back(pose);
  }
  track.info = recording.info();
  if (track.info.kind == SampleKind::one_axis) {
    throw InputError(name, "holds the position along one axis",
                     "readings need a point in space or three points; use condyle replay");
  }
  track.has_rotation = track.info.kind != SampleKind::one_point;
  if (track.info.kind == SampleKind::three_points) {
    refuse_if_short(points.size(), track.counts, name);
    track.step_m = step_of_points(
        points.size(), 3, [&](std::size_t k) -> const Matrix3d& { return points[k].points_m; });
    fit_body(points, name, track);
  }
  refuse_if_short(track.pose.size(), track.counts, name);
  keep_usable(track);
  refuse_if_short(track.pose.size(), track.counts, name);
  return track;
}

ReferredMotion motion_from(const PoseTrack& track, std::size_t begin, std::size_t end,
                           MovingBody moving) {
  const Isometry3d reference = mean_pose(track.pose, begin, end);
  const Isometry3d back = reference.inverse(Eigen::Isometry);
  ReferredMotion result;
  result.middle_m = reference.translation();
  result.time_s = track.time_s;
  result.jumps_s = track.jumps_s;
  result.motion.resize(track.pose.size());
  run_in_blocks(track.pose.size(), kSamplesInBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      Isometry3d moved = track.pose[i] * back;
      if (moving == MovingBody::upper) moved = moved.inverse(Eigen::Isometry);
      result.motion[i] << moved * result.middle_m - result.middle_m,
          rotation_vector_of<double>(moved.linear());
    }
  });
  return result;
}

std::optional<double> first_jump_s(const ReferredMotion& motion, std::size_t begin,
                                   std::size_t end) {
  if (end <= begin) return std::nullopt;
  const auto& jumps_s = motion.jumps_s;
  const auto jump = std::lower_bound(jumps_s.begin(), jumps_s.end(), motion.time_s[begin]);
  if (jump == jumps_s.end() || *jump > motion.time_s[end - 1]) return std::nullopt;
  return *jump;
}

}  // namespace condyle::host
