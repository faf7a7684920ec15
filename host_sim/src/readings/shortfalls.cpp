// SPDX-License-Identifier: Apache-2.0
#include "readings/shortfalls.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace condyle::host {
namespace {

constexpr std::string_view kGreatestValues[] = {"displacement_mm",
                                                "rotation_deg",
                                                "opening_mm",
                                                "opening_vertical_mm",
                                                "opening_angle_deg",
                                                "protrusion_mm",
                                                "laterotrusion_mm",
                                                "yaw_angle_deg",
                                                "condylar_translation_mm",
                                                "condylar_translation_difference_mm",
                                                "cycle_height_mm",
                                                "cycle_width_mm",
                                                "cycle_depth_mm"};
constexpr std::string_view kReadAtTop[] = {"opening_deflection_mm",      "helical_axis_x_mm",
                                           "helical_axis_z_mm",          "working_shift_mm",
                                           "working_shift_angle_deg",    "condylar_path_mm",
                                           "condylar_path_difference_mm"};
// What noise explains of a shortfall, in standard deviations; how often the rest is in the
// interval, because smoothing hides a part of a short top.
constexpr double kExplained = 2, kTimesShortfall = 1.5;

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void take_shortfalls(const std::vector<std::string_view>& names,
                     std::vector<UncertainValue>& values) {
  for (std::size_t i = names.size(); i-- > 0;) {
    const bool is_at_top = is_among(kReadAtTop, names[i]);
    if (!is_at_top && !is_among(kGreatestValues, names[i])) continue;
    const UncertainValue shortfall = values.back();
    values.pop_back();
    UncertainValue& value = values[i];
    if (!std::isfinite(shortfall.value)) continue;
    const double explained = kExplained * shortfall.noise_sd;
    const double left = std::max(shortfall.value, 0.0);
    const double rest = std::max(left * left - explained * explained, 0.0);
    value.doubt = std::hypot(value.doubt, kTimesShortfall * std::sqrt(rest));
    if (is_at_top) {
      value.doubt = std::hypot(value.doubt, shortfall.of_contradiction());
      continue;
    }
    // The signs of a difference do not tell to which of both tops the shortfall belongs.
    value.contradiction = names[i].ends_with("difference_mm")
                              ? std::abs(value.contradiction) + std::abs(shortfall.contradiction)
                              : value.contradiction + shortfall.contradiction;
    value.contradiction_sd = std::hypot(value.contradiction_sd, shortfall.contradiction_sd);
  }
}

}  // namespace condyle::host
