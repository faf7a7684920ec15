// SPDX-License-Identifier: Apache-2.0
// Landmarks from a recording of a pointer, or of a point held to each landmark.
//
//   p_k    tip; J_k, H_k   poses of jaw and head; all in the instrument's frame
//   J, H   their mean poses in the reference position, the jaw's with the head at H
//   landmark of the jaw    J J_k^-1 p_k, if the jaw is tracked
//   landmark of the head   H H_k^-1 p_k, if the head is tracked
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "readings/body_tracks.h"
#include "readings/landmarks.h"
#include "readings/pointer.h"

namespace condyle::host {

/// Begin and end (s).
using TimeSpan = std::array<double, 2>;

/// How to take landmarks.
struct LandmarkPlan {
  std::vector<std::string> pointer;  ///< its points; empty: `point` touches the landmarks itself
  std::string point;
  std::optional<Eigen::Vector3d> tip_m;  ///< in the frame of the pointer's first three points
  std::optional<TimeSpan> calibration_s;
  std::array<std::optional<TimeSpan>, Landmarks::kPoints> at_s;
  BodyChoice bodies;  ///< without names they are not tracked
  std::optional<TimeSpan> reference_s;
  double touch_sd_mm = 1;  ///< how well the landmarks were found
  std::string kind = "palpated", plane = "not stated";
};

/// A landmark as it was touched.
struct TakenLandmark {
  double scatter_m = 0;  ///< standard deviation along each axis
  std::size_t samples = 0;
  double begin_s = 0, end_s = 0;
};

struct TakenLandmarks {
  Landmarks landmarks;
  std::array<TakenLandmark, Landmarks::kPoints> taken;
  std::optional<PointerTip> tip;  ///< calibrated; in the frame of the pointer's first three points
  std::vector<std::string> notes;
};

/// Takes the landmarks of `plan` from `points`, the recording `name`. Throws InputError if one
/// cannot be known.
TakenLandmarks take_landmarks(const NamedPoints& points, const LandmarkPlan& plan,
                              const std::string& name);

/// As a file for load_landmarks.
std::string landmarks_toml(const TakenLandmarks& taken, const std::string& name);

}  // namespace condyle::host
