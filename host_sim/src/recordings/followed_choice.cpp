// SPDX-License-Identifier: Apache-2.0
#include "recordings/followed_choice.h"

#include <fmt/format.h>

#include "hosted/files/input_error.h"

namespace condyle::host {

void FollowedChoice::check(const std::string& source, SampleKind kind) const {
  if (!is_available(kind, followed)) {
    throw InputError(source, fmt::format("has one point, not point {}", followed.point),
                     "leave out --point");
  }
  if (kind == SampleKind::one_axis && axis_given) {
    throw InputError(source, "has one axis, so there is none to choose", "leave out --axis");
  }
  const bool has_pose = kind == SampleKind::three_points || kind == SampleKind::pose;
  if (!jaw_point_mm.empty() && !has_pose) {
    throw InputError(source, "has no three points, so the jaw's pose is not known",
                     "leave out --jaw-point-mm");
  }
}

FollowedPoint FollowedChoice::point(BodyFits* fits) const {
  FollowedPoint point{.point = followed.point, .fits = fits};
  if (!jaw_point_mm.empty()) {
    point.body_point_m = 1e-3 * Eigen::Map<const Eigen::Vector3d>(jaw_point_mm.data());
  }
  return point;
}

std::string FollowedChoice::text(SampleKind kind) const {
  if (kind == SampleKind::one_axis) return "one axis";
  const std::string point = jaw_point_mm.empty()
                                ? fmt::format("point {}", followed.point)
                                : fmt::format("jaw point ({:g}) mm", fmt::join(jaw_point_mm, ", "));
  return fmt::format("{}, axis {}", point, "xyz"[static_cast<int>(followed.axis)]);
}

std::optional<double> FollowedPositions::position_m(const Sample& sample) {
  if (choice_.jaw_point_mm.empty()) {
    if (!sample.position_valid) return std::nullopt;
    return followed_position_m(sample, choice_.followed);
  }
  const FollowedPosition followed = follower_.follow(sample);
  if (followed.status != PoseStatus::ok) return std::nullopt;
  return followed.position_m[static_cast<int>(choice_.followed.axis)];
}

}  // namespace condyle::host
