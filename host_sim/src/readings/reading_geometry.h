// SPDX-License-Identifier: Apache-2.0
// Points of the jaw in the head frame: X anterior, Y left, Z superior, origin between the condylar
// points in the reference position (landmarks.h).
//
//   u, w   displacement of the middle f of the measured points, and rotation vector: of
//   ReferredMotion d(b)   displacement of the jaw's point b: u + (R(w) - I)(b - f) v(b)   its
//   velocity: u' + omega x R(w)(b - f), omega = J(w) w', J the left Jacobian of SO(3)
// both turned into the head frame.
#pragma once

#include <array>
#include <optional>

#include "readings/landmarks.h"
#include "readings/local_fit.h"

namespace condyle::host {

/// The points whose paths are read, and the head frame's axes, in the instrument's frame.
struct ReadingGeometry {
  bool has_landmarks = false;
  Eigen::Isometry3d head = Eigen::Isometry3d::Identity();
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();           ///< f
  Eigen::Vector3d incisor_m = Eigen::Vector3d::Zero();          ///< or another followed point
  std::array<Eigen::Vector3d, 2> condyle_m{};                   ///< left, right
  Eigen::Vector3d reference_shift_m = Eigen::Vector3d::Zero();  ///< error of the reference
  Eigen::Vector3d reference_turn_rad = Eigen::Vector3d::Zero();
};

/// The geometry of `landmarks`.
ReadingGeometry geometry_of(const Landmarks& landmarks, const Eigen::Vector3d& middle_m);

/// Paths in the head frame: displacements from the reference (m), velocities (m/s), rotations.
struct JawPath {
  std::vector<double> time_s;
  std::vector<Eigen::Vector3d> incisor_m, incisor_m_s;
  std::array<std::vector<Eigen::Vector3d>, 2> condyle_m, condyle_m_s;
  std::vector<Eigen::Vector3d> rotation_rad;      ///< rotation vectors
  std::vector<Eigen::Vector3d> turning_rad_s;     ///< angular velocities
  std::array<Eigen::Vector3d, 2> condyle_at_m{};  ///< the condyles in the reference position
  Eigen::Vector3d incisor_at_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d middle_at_m = Eigen::Vector3d::Zero();  ///< f
  std::vector<Eigen::Vector3d> middle_m;                  ///< displacement of f
  bool is_exact = false;  ///< without noise: a greatest value is not sought among means
};

/// Which parts of a path are wanted: all, or time and incisor.
enum class PathPart { all, incisor };

/// R and omega at the samples of a motion, which do not depend on the points.
struct TurningMotion {
  std::vector<Eigen::Matrix3d> rotation;
  std::vector<Eigen::Vector3d> angular_velocity_rad_s;
};
void turning_of(const SmoothMotion& motion, TurningMotion& turning);

/// The paths of `motion`, whose turning is given; the parts that are not wanted stay as they are.
void paths_of(const SmoothMotion& motion, const TurningMotion& turning,
              const ReadingGeometry& geometry, PathPart part, JawPath& path);
/// All paths of `motion`.
void paths_of(const SmoothMotion& motion, const ReadingGeometry& geometry, JawPath& path);

/// Angle of the twist of the rotation `vector_rad` about `axis`, of swing and twist (rad).
double twist_about(const Eigen::Vector3d& vector_rad, int axis);

}  // namespace condyle::host
