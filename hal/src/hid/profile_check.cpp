// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/hid/profile_check.h"

#include <algorithm>

#include "hid/layout_text.h"

namespace condyle::hal {
namespace {

// For any profile with at most kMaxAuxiliary auxiliary fields, usable or not.
ReportLayout bare_layout_of(const DeviceProfile& profile) {
  ReportLayout layout{profile, {}};
  for (const AuxiliaryField& auxiliary : profile.auxiliary) {
    layout.auxiliary.push_back(auxiliary.field);
  }
  return layout;
}

std::optional<ProfileProblem> check_auxiliary(const DeviceProfile& profile) {
  const auto& all = profile.auxiliary;
  const auto problem = [](std::size_t index, const char* reason, std::string mend) {
    return ProfileProblem{ProfilePart::auxiliary, index, reason, std::move(mend)};
  };
  if (all.size() > kMaxAuxiliary) {
    return problem(kMaxAuxiliary, "too many auxiliary fields",
                   "give at most " + std::to_string(kMaxAuxiliary));
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name.empty() || all[i].unit.empty()) {
      return problem(i, "an auxiliary field has no name or unit", "give both");
    }
    const auto is_namesake = [&](const AuxiliaryField& other) { return other.name == all[i].name; };
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find_if(all.begin(), end, is_namesake) != end) {
      return problem(i, "two auxiliary fields have the same name", "name each once");
    }
  }
  return {};
}

}  // namespace

std::optional<ProfileProblem> find_problem(const DeviceProfile& profile) {
  if (profile.descriptor_axes && !profile.coordinates.empty()) {
    return ProfileProblem{ProfilePart::coordinates, 0,
                          "coordinates are given and also requested from the descriptor",
                          "do only one of the two"};
  }
  if (auto problem = check_auxiliary(profile)) return problem;
  const LayoutState state =
      profile.descriptor_axes ? LayoutState::awaits_descriptor : LayoutState::complete;
  const auto found = find_layout_problem(bare_layout_of(profile), state);
  if (!found) return {};
  return words_of(*found, profile, state);
}

ReportLayout layout_of(const DeviceProfile& profile) {
  if (profile.descriptor_axes || find_problem(profile)) return {};
  return bare_layout_of(profile);
}

const char* coordinate_name(SampleKind kind, std::size_t index) {
  constexpr const char* points[] = {"x1", "y1", "z1", "x2", "y2", "z2", "x3", "y3", "z3"};
  constexpr const char* pose[] = {"x", "y", "z", "qw", "qx", "qy", "qz"};
  if (index >= coordinate_count(kind)) return "?";
  if (kind == SampleKind::one_axis) return "position";
  return kind == SampleKind::three_points ? points[index] : pose[index];
}

}  // namespace condyle::hal
