// SPDX-License-Identifier: Apache-2.0
#include "readings/stroke_checks.h"

#include <fmt/format.h>

#include <algorithm>

namespace condyle::host {
namespace {

constexpr double kMostAtEnds = 0.5;  // of the greatest distance
constexpr double kMostOnset_m = 1e-3, kOnsetTime_s = 0.4;

// Share of the distance that the turning point must have in the task's direction.
bool is_in_direction(TaskKind kind, const Eigen::Vector3d& turn_m) {
  const double distance_m = turn_m.norm();
  switch (kind) {
    case TaskKind::opening:
      return -turn_m.z() > 0.5 * distance_m;
    case TaskKind::protrusion:
      return turn_m.x() > 0.3 * distance_m;
    case TaskKind::left:
      return turn_m.y() > 0.4 * distance_m;
    case TaskKind::right:
      return -turn_m.y() > 0.4 * distance_m;
    default:
      return true;
  }
}

}  // namespace

std::string problem_of_stroke(TaskKind kind, bool has_landmarks, const JawPath& path,
                              SampleRun stroke) {
  const auto& points = path.incisor_m;
  std::size_t turn = stroke.begin;
  for (std::size_t k = stroke.begin; k < stroke.end; ++k) {
    if (points[k].norm() > points[turn].norm()) turn = k;
  }
  const double most_m = kMostAtEnds * points[turn].norm();
  const bool begins_near = points[stroke.begin].norm() <= most_m;
  const bool ends_near = points[stroke.end - 1].norm() <= most_m;
  if (!begins_near || !ends_near) {
    return fmt::format("the {} of the stroke is cut off; give the whole movement to the task",
                       begins_near ? "end" : "beginning");
  }
  if (has_landmarks && !is_in_direction(kind, points[turn])) {
    return fmt::format(
        "the incisor moves by ({:.1f}, {:.1f}, {:.1f}) mm forward, left and up, which is not {}; "
        "check the task, the landmarks and --moving",
        points[turn].x() * 1e3, points[turn].y() * 1e3, points[turn].z() * 1e3, name_of(kind));
  }
  return "";
}

std::string problem_of_onset(const JawPath& path, SampleRun stroke) {
  double least_m = path.incisor_m[stroke.begin].norm();
  for (std::size_t k = stroke.begin;
       k < stroke.end && path.time_s[k] - path.time_s[stroke.begin] <= kOnsetTime_s; ++k) {
    least_m = std::min(least_m, path.incisor_m[k].norm());
  }
  if (least_m <= kMostOnset_m) return "";
  return fmt::format(
      "the stroke begins {:.1f} mm from the reference position, where the condyles have already "
      "travelled",
      least_m * 1e3);
}

}  // namespace condyle::host
