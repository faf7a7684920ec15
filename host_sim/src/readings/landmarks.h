// SPDX-License-Identifier: Apache-2.0
// Anatomical landmarks as a TOML file, in the instrument's frame, with the jaw in the reference
// position; the head frame that they define.
//
//   L, R   condylar points; P_l, P_r, P_f   points of the reference plane; I   lower incisor (m)
//   origin of the head frame   (L + R) / 2
//   Z   unit normal of the plane, on the side opposite to I
//   Y   (L - R) without its part along Z, normalised: left
//   X   Y x Z: anterior
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

namespace condyle::host {

/// Named points of a body where the landmarks hold, in the instrument's frame (m).
struct StatedBody {
  std::vector<std::string> names;  ///< empty: not stated
  Eigen::Matrix3Xd points_m;       ///< one a column
};

/// The landmarks and their standard deviations along each axis (m).
struct Landmarks {
  enum Point { condyle_left, condyle_right, incisor_lower, plane_left, plane_right, plane_front };
  static constexpr std::size_t kPoints = 6;
  /// Names of the points, as keys of the file.
  static constexpr std::array<const char*, kPoints> kNames = {
      "condyle_left", "condyle_right", "incisor_lower", "plane_left", "plane_right", "plane_front"};

  std::array<Eigen::Vector3d, kPoints> point_m;
  std::array<double, kPoints> sd_m{};
  std::string condyle_kind = "not stated";  ///< kinematic, hinge, palpated or arbitrary
  std::string plane = "not stated";         ///< Frankfurt, Camper or axis-orbital
  StatedBody jaw, head;
};

/// Axes of the head frame as columns X, Y, Z in the instrument's frame, at its origin.
Eigen::Isometry3d head_frame(const Landmarks& landmarks);

/// Reads the file. Every problem is an InputError that names file, line and remedy; so are points
/// that define no frame.
Landmarks load_landmarks(const std::string& path);
/// The same for the file's `text`; messages call it `name`.
Landmarks landmarks_from(const std::string& text, const std::string& name);

/// Throws an InputError that names `path` if the landmarks lie too far from `middle_m`, the middle
/// of the measured points in the reference position, to belong to the same jaw.
void check_near(const Landmarks& landmarks, const Eigen::Vector3d& middle_m,
                const std::string& path);

}  // namespace condyle::host
