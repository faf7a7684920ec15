// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "simulation/instrument.h"
#include "simulation/kinematic/kinematic_jaw.h"

namespace condyle::host {

/// The fork's points in its own frame (m), one a column.
Eigen::Matrix3d fork_points_m();

/// A facebow that sees a fork in any pose. What happens to a sample is as in
/// simulation/instrument.h. Its noise moves the centroid of the three points along, and turns the
/// fork about, each axis of the instrument independently.
class ForkFacebow {
 public:
  ForkFacebow(const FacebowModel& model, std::uint64_t seed);

  /// Instant of the next sample (s).
  double next_instant_s() const { return faults_.next_instant_s(); }
  /// Takes the fork's pose in the instrument's frame at that instant; appends its samples (none
  /// when lost, two when repeated).
  void sample(const JawPose& fork, std::vector<Sample>& samples);

 private:
  // Of the fork; the position is that of the points' centroid.
  struct Placement {
    Eigen::Quaterniond turn;
    Eigen::Vector3d centroid_m;
  };

  FacebowModel model_;
  RandomGenerator noise_;
  FacebowFaults faults_;
  std::optional<Placement> smoothed_, shown_;
};

}  // namespace condyle::host
