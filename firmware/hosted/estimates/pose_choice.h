// SPDX-License-Identifier: Apache-2.0
// What is shown of the whole pose.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"

namespace condyle::host {

/// A named point fixed to the jaw.
struct JawPoint {
  std::string name;
  /// In the frame of the three points, or in the pose's own frame (m).
  Eigen::Vector3d jaw_m = Eigen::Vector3d::Zero();
};

/// The user's choice.
struct PoseChoice {
  Axis twist_axis = Axis::x;  ///< of the instrument; the jaw turns about it as twist, else as swing
  std::vector<JawPoint> points;

  Eigen::Vector3d twist_direction() const {
    return Eigen::Vector3d::Unit(static_cast<Eigen::Index>(twist_axis));
  }

  /// Adds a point. Throws an InputError that names `place` if another value or point has its name,
  /// or if the name is not a letter and up to 31 letters, digits, - and _.
  void add_point(const std::string& place, const JawPoint& point);
};

/// Throws an InputError if samples of `kind`, from `source`, have no pose; `mend` is the remedy.
void refuse_without_pose(const std::string& source, SampleKind kind, const std::string& mend);

}  // namespace condyle::host
