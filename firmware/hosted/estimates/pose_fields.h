// SPDX-License-Identifier: Apache-2.0
// The values of a pose estimate: their names, order and units in files and messages.
#pragma once

#include <string>

#include "condyle/estimator/pose/pose_estimate.h"
#include "hosted/estimates/pose_choice.h"

namespace condyle::host {

/// Name and unit of a quantity or a vector.
struct PoseName {
  std::string name, unit;
  std::string squared_unit = {};  ///< of its covariances

  /// "twist_rad", "twist_sd_rad"; of an axis: "centre_x_m", "centre_x_sd_m".
  std::string value() const { return name + "_" + unit; }
  std::string standard_deviation() const { return name + "_sd_" + unit; }
  std::string value(char axis) const { return name + "_" + axis + "_" + unit; }
  std::string standard_deviation(char axis) const { return name + "_" + axis + "_sd_" + unit; }
  /// "centre_xy_covariance_m2".
  std::string covariance(char a, char b) const {
    return name + "_" + a + b + "_covariance_" + squared_unit;
  }
  /// "centre_covariances_m2": all of them.
  std::string covariances() const { return name + "_covariances_" + squared_unit; }
  std::string provenance() const { return name + "_provenance"; }
};

/// Pairs of axes, in the order of the covariances.
inline constexpr int kAxisPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};

/// Name of the velocity of the point `name`.
inline std::string velocity_name(const std::string& name) {
  return name + "_velocity";
}

/// Below this many standard deviations a swing, which is never negative, is noise.
inline constexpr double kSwing_sd = 2;

/// `swing_rad` as it is shown: noise is not `measured`.
inline Quantity<double> shown_swing(Quantity<double> swing_rad) {
  if (swing_rad.provenance == Provenance::not_computed) return swing_rad;
  if (!(swing_rad.value > kSwing_sd * swing_rad.standard_deviation)) {
    swing_rad.provenance = Provenance::assumed;
  }
  return swing_rad;
}

/// Calls `vector(name, VectorEstimate)` and `quantity(name, Quantity)` for all values, in the order
/// of the columns. A vector whose name has no squared unit has no covariances between axes.
template <class Vector, class Value>
void visit_pose(const PoseEstimate<double>& pose, const PoseChoice& choice, Vector&& vector,
                Value&& quantity) {
  vector(PoseName{"centre", "m"}, pose.centre_m);
  vector(PoseName{"centre_velocity", "m_s"}, pose.centre_velocity_m_s);
  vector(PoseName{"rotation_vector", "rad"}, pose.rotation_vector_rad);
  vector(PoseName{"angular_velocity", "rad_s", "rad2_s2"}, pose.angular_velocity_rad_s);
  const TurnEstimate<double> turn = pose.turn_about(choice.twist_direction());
  quantity(PoseName{"twist", "rad"}, turn.twist_rad);
  quantity(PoseName{"twist_rate", "rad_s"}, turn.twist_rate_rad_s);
  quantity(PoseName{"swing", "rad"}, shown_swing(turn.swing_rad));
  for (const JawPoint& point : choice.points) {
    const PointEstimate<double> estimate = pose.point(point.jaw_m);
    vector(PoseName{point.name, "m", "m2"}, estimate.position_m);
    vector(PoseName{velocity_name(point.name), "m_s", "m2_s2"}, estimate.velocity_m_s);
  }
}

}  // namespace condyle::host
