// SPDX-License-Identifier: Apache-2.0
// The poses of a whole recording: read, checked against their neighbours on both sides, and related
// to a reference position.
//
// A sample is not used if it is missing, does not fit the body of its three points, runs backwards
// in time, or belongs to a burst: a run of at most 0.2 s that departs with a jump from a path which
// a cubic over the samples before and after it describes well. A jaw may make it if its first and
// last steps are slower than 1 m/s.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "readings/point_body.h"
#include "recordings/recording_choice.h"

namespace condyle::host {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Samples of a recording and what became of them.
struct PoseCounts {
  std::uint64_t samples = 0, missing = 0, not_rigid = 0, time_reversed = 0, in_bursts = 0,
                frozen = 0;
};

/// A body of the points of a recording.
struct TrackedBody {
  std::vector<std::string> names;  ///< of the points; empty: three points without names
  PointColumns shape_m;            ///< relative to their middle, one a column
  double residual_m = 0;           ///< of the fit, not exceeded in 90 % of the samples
};

/// The usable samples.
struct PoseTrack {
  RecordingInfo info;
  PoseCounts counts;
  bool has_rotation = false;                 ///< three points or poses, not one point
  TrackedBody jaw, head;                     ///< the head without names: it is not tracked
  std::vector<double> time_s;                ///< on the recording's clock
  std::vector<Eigen::Isometry3d> pose;       ///< orientation, and place of the points' middle (m)
  std::vector<Eigen::Isometry3d> head_pose;  ///< of a tracked head, in the instrument's frame
  Eigen::Isometry3d head_at = Eigen::Isometry3d::Identity();  ///< the head's for which `pose` holds
  double noise_growth = 1;  ///< of the variance, where points are missing
  double step_m = 0;        ///< of the coordinates of three points (number_step.h); 0: not known
  std::vector<double> jumps_s;             ///< times of samples in bursts that a jaw may make
  std::string body_problem;                ///< why a body cannot be trusted; empty: it can
  std::vector<std::string> events, notes;  ///< bursts, as text; what was read how
};

/// Reads `recording`, which messages call `name`. Throws InputError if it cannot be used.
PoseTrack read_poses(Recording& recording, const std::string& name);

/// Takes bursts and frozen poses out of `track`, and counts them.
void keep_usable(PoseTrack& track);

/// Fewest samples of a recording.
inline constexpr std::size_t kLeastSamples = 10;
/// Throws an InputError that names `name` if fewer are usable.
void refuse_if_short(std::size_t usable, const PoseCounts& counts, const std::string& name);

/// The residual beyond which a sample does not fit its body, from those of all samples (m).
double residual_tolerance_m(const std::vector<double>& residuals_m);
/// The residual that 90 % of the samples do not exceed (m).
double usual_residual_m(std::vector<double> residuals_m);

/// Which body moves relative to the instrument.
enum class MovingBody { lower, upper };

/// The jaw's motion relative to the head, from the reference position, in the instrument's frame:
/// displacement of the middle of the points (m), then rotation vector (rad).
struct ReferredMotion {
  Eigen::Vector3d middle_m;  ///< of the points, in the reference position
  std::vector<double> time_s;
  std::vector<Vector6> motion;
  /// Times of the samples that were not used, although a jaw may move so (s, rising). What is read
  /// of short movements beside them is not known.
  std::vector<double> jumps_s;
};

/// The motion of `track` relative to the mean pose of the samples from `begin` to `end` (without).
ReferredMotion motion_from(const PoseTrack& track, std::size_t begin, std::size_t end,
                           MovingBody moving);

/// The first of `motion.jumps_s` between the samples `begin` and `end` (without) (s).
std::optional<double> first_jump_s(const ReferredMotion& motion, std::size_t begin,
                                   std::size_t end);

}  // namespace condyle::host
