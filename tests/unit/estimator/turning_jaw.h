// SPDX-License-Identifier: Apache-2.0
// A jaw that opens and closes, as a measured pose with white noise in six degrees of freedom.
#pragma once

#include <numbers>

#include "condyle/estimator/pose/pose_estimator.h"
#include "support/random.h"

namespace condyle::testing_support {

/// Noise of the instrument.
inline constexpr double kPositionNoise_m = 5e-5, kRotationNoise_rad = 2e-3;
/// 100 mm from the body's centre.
inline const Eigen::Vector3d kCondyle_m(0.05, -0.02, -0.085);

/// Opens about the hinge, swings sideways, and its centre travels, all at one frequency.
struct JawMotion {
  double frequency_Hz = 1;
  double angle_rad = 0.25;  ///< from closed to open
  double travel_m = 0.010;  ///< of the centre, from closed to open

  static Eigen::Vector3d hinge() { return {0.96, 0.28, 0}; }

  /// Truth at `time_s`; the body's centre is the jaw frame's origin.
  Pose<double> pose(double time_s) const {
    const double phase = 2 * std::numbers::pi * frequency_Hz * time_s;
    const double open = (1 - std::cos(phase)) / 2, side = std::sin(phase + 1);
    const Eigen::Vector3d opening = angle_rad * open * hinge();
    const Eigen::Vector3d swing = 0.2 * angle_rad * side * Eigen::Vector3d(0, 0.6, 0.8);
    const Eigen::Vector3d travel = travel_m * Eigen::Vector3d(0.2 * side, 0.4 * open, -open);
    return {rotation_of(swing) * rotation_of(opening), Eigen::Vector3d(0.1, -0.2, 0.3) + travel};
  }
  /// In the instrument's frame.
  Eigen::Vector3d angular_velocity_rad_s(double time_s) const {
    const Eigen::Matrix3d turn =
        pose(time_s + kStep_s).rotation * pose(time_s - kStep_s).rotation.transpose();
    return rotation_vector_of(turn) / (2 * kStep_s);
  }
  /// Of the jaw-fixed point `body_point_m`.
  Eigen::Vector3d velocity_m_s(double time_s, const Eigen::Vector3d& body_point_m) const {
    return (point_of(pose(time_s + kStep_s), body_point_m) -
            point_of(pose(time_s - kStep_s), body_point_m)) /
           (2 * kStep_s);
  }

 private:
  static constexpr double kStep_s = 1e-5;
};

/// Three independent normal numbers.
inline Eigen::Vector3d normal_vector(Random& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

/// `pose` as an instrument with this noise measures it.
inline Pose<double> noisy(const Pose<double>& pose, double position_sd_m, double rotation_sd_rad,
                          Random& random) {
  const Eigen::Vector3d turn = rotation_sd_rad * normal_vector(random);
  return {rotation_of(turn) * pose.rotation,
          pose.translation + position_sd_m * normal_vector(random)};
}

/// `pose`, measured at `time_s`.
inline TimedPose<double> timed(double time_s, const Pose<double>& pose) {
  TimedPose<double> measurement;
  measurement.time_ns = nanoseconds(time_s);
  measurement.is_measured = true;
  measurement.pose = pose;
  return measurement;
}

}  // namespace condyle::testing_support
