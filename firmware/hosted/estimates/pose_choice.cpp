// SPDX-License-Identifier: Apache-2.0
#include "hosted/estimates/pose_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "hosted/estimates/pose_fields.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

constexpr std::size_t kLongestName = 32, kMostPoints = 16;

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName && is_letter(name[0]) &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return is_letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '_';
         });
}

// The names that the values of `choice` begin with.
std::vector<std::string> taken_names(const PoseChoice& choice) {
  std::vector<std::string> names;
  PoseEstimate<double> none;
  visit_pose(
      none, choice, [&names](const PoseName& name, const auto&) { names.push_back(name.name); },
      [&names](const PoseName& name, const auto&) { names.push_back(name.name); });
  return names;
}

}  // namespace

void PoseChoice::add_point(const std::string& place, const JawPoint& point) {
  if (!is_name(point.name)) {
    throw InputError(place, quote(point.name) + " is not a name for a point",
                     "begin with a letter; use at most 32 letters, digits, - and _");
  }
  if (points.size() >= kMostPoints) {
    throw InputError(place, "too many points", fmt::format("give at most {}", kMostPoints));
  }
  const std::vector<std::string> taken = taken_names(*this);
  for (const std::string& name : {point.name, velocity_name(point.name)}) {
    if (std::find(taken.begin(), taken.end(), name) == taken.end()) continue;
    throw InputError(place, fmt::format("{} is already the name of a value", name),
                     "give the point another name");
  }
  points.push_back(point);
}

void refuse_without_pose(const std::string& source, SampleKind kind, const std::string& mend) {
  if (kind == SampleKind::three_points || kind == SampleKind::pose) return;
  throw InputError(source, "has no three points and no orientation, so the jaw's pose is not known",
                   mend);
}

}  // namespace condyle::host
