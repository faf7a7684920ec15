// SPDX-License-Identifier: Apache-2.0
// The jaw, and the head if it is tracked too, as rigid bodies of named points.
//
//   J_k, H_k   poses of jaw and head in the instrument's frame; H   the head's in the reference
//   position H H_k^-1 J_k   the jaw as the instrument would see it if the head had stayed at H
#pragma once

#include <string>
#include <vector>

#include "readings/landmarks.h"
#include "readings/pose_track.h"
#include "recordings/named_points.h"

namespace condyle::host {

/// The points of the bodies, by name.
struct BodyChoice {
  std::vector<std::string> jaw;   ///< empty: all that are not the head's
  std::vector<std::string> head;  ///< empty: the head is not tracked

  bool is_given() const { return !jaw.empty() || !head.empty(); }
};

/// The names in `text`, "A,B,C". Throws an InputError that names `option` if one is empty or given
/// twice, or if there are fewer than `least` or more than kMostBodyPoints.
std::vector<std::string> point_names(const std::string& text, const std::string& option,
                                     std::size_t least = 3);

/// The numbers of the points `wanted` among `names`. Throws an InputError that names `option`, the
/// unknown name, the nearest one and all names.
std::vector<Eigen::Index> points_by_name(const std::vector<std::string>& wanted,
                                         const std::vector<std::string>& names,
                                         const std::string& option);

/// A body's points in all samples of a recording.
struct NamedPoints {
  RecordingInfo info;
  PoseCounts counts;
  std::vector<std::string> names;
  std::vector<double> time_s;          ///< rises
  std::vector<PointColumns> points_m;  ///< all of them, NaN for missing ones
};

/// Reads all samples of `recording` with a time. Points without names are p1, p2 and p3. Throws an
/// InputError that names `name` if it has none.
NamedPoints read_named_points(Recording& recording, const std::string& name);

/// Poses of one body.
struct BodyPoses {
  TrackedBody body;
  std::vector<BodyFit> fits;  ///< of each sample
  double step_m = 0;          ///< of its points' coordinates (number_step.h); 0: none is seen
  std::string problem;        ///< why the body cannot be trusted; empty: it can
  std::size_t too_few = 0;  ///< samples with too few points, or with points that add too much noise
  std::size_t not_rigid = 0;  ///< samples that do not fit the body
};

/// The body of the points called `wanted`, which messages call `body` and `option` states. What
/// does not fit is not `is_fitted`. Throws InputError if they are no body.
BodyPoses fit_body(const NamedPoints& points, const std::vector<std::string>& wanted,
                   const std::string& body, const std::string& option, const std::string& name);

/// The poses of the jaw of `recording`, which messages call `name`; relative to the head if it is
/// tracked, as seen with the head where it is in the first sample. Throws InputError if they cannot
/// be used.
PoseTrack read_bodies(NamedPointsRecording& recording, const std::string& name,
                      const BodyChoice& bodies);

/// True if `recording` is read as bodies: if `bodies` are given, or if it has more than three
/// points with names.
bool is_read_as_bodies(const Recording& recording, const BodyChoice& bodies);

/// The poses of `recording`: those of `bodies` if it is read as bodies, otherwise as read_poses
/// does. Throws InputError if it lacks the points.
PoseTrack read_track(Recording& recording, const std::string& name, const BodyChoice& bodies);

/// The same poses as seen with the head at `head_at`.
void refer_to_head(PoseTrack& track, const Eigen::Isometry3d& head_at);

}  // namespace condyle::host
