// SPDX-License-Identifier: Apache-2.0
// The poses of a whole recording: read, checked against their neighbours on both sides, and related
// to a reference position.
//
// A sample is not used if it is missing, does not fit the body of its three points, runs backwards
// in time, or belongs to a burst: a run of at most 0.2 s that departs with a jump from a path which
// a cubic over the samples before and after it describes well.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "recordings/recording_choice.h"

namespace condyle::host {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Samples of a recording and what became of them.
struct PoseCounts {
  std::uint64_t samples = 0, missing = 0, not_rigid = 0, time_reversed = 0, in_bursts = 0,
                frozen = 0;
};

/// The usable samples.
struct PoseTrack {
  RecordingInfo info;
  PoseCounts counts;
  bool has_rotation = false;   ///< three points or poses, not one point
  Eigen::Matrix3d body_m;      ///< the three points relative to their middle, one a column
  double residual_m = 0;       ///< of the fit of the body, not exceeded in 90 % of the samples
  std::vector<double> time_s;  ///< on the recording's clock
  std::vector<Eigen::Isometry3d> pose;  ///< orientation, and place of the points' middle (m)
  std::vector<std::string> events;      ///< bursts, as text
};

/// Reads `recording`, which messages call `name`. Throws InputError if it cannot be used.
PoseTrack read_poses(Recording& recording, const std::string& name);

/// Which body moves relative to the instrument.
enum class MovingBody { lower, upper };

/// The jaw's motion relative to the head, from the reference position, in the instrument's frame:
/// displacement of the middle of the points (m), then rotation vector (rad).
struct ReferredMotion {
  Eigen::Vector3d middle_m;  ///< of the points, in the reference position
  std::vector<double> time_s;
  std::vector<Vector6> motion;
};

/// The motion of `track` relative to the mean pose of the samples from `begin` to `end` (without).
ReferredMotion motion_from(const PoseTrack& track, std::size_t begin, std::size_t end,
                           MovingBody moving);

}  // namespace condyle::host
