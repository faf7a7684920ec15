// SPDX-License-Identifier: Apache-2.0
#include "readings/stroke_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "readings/axis_readings.h"
#include "readings/chewing_cycles.h"
#include "readings/condyle_readings.h"
#include "readings/convex_hull.h"
#include "readings/reading_values.h"
#include "readings/smoothness.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kNone = JawReading::kNone;
constexpr double kDegree = std::numbers::pi / 180, kMillimetre = 1e-3;
constexpr double kLeastSpeedShare = 0.05;  // of the peak: begin and end of a movement
constexpr double kLeastPartShare = 0.2;    // of the peak: a part before or after a stop
constexpr double kReturn_m = 1e-3;         // near the reference position
// Of the spread of instantaneous axes, on motion without noise.
constexpr double kSpreadError_mm = 0.1;
constexpr double kShareOfSmoothing = 0.5;

// Speed from `begin` to `end` (without): its peak, and the movement around the peak. Stops on the
// way belong to it.
struct Movement {
  double peak_m_s, begin_s, end_s;
};

Movement movement_of(const JawPath& path, const std::vector<double>& speeds, std::size_t begin,
                     std::size_t end) {
  const auto& time_s = path.time_s;
  const Greatest peak = greatest_of(time_s, speeds, begin, end, top_reach_s(path));
  const double least = kLeastSpeedShare * peak.value;
  const double of_part = kLeastPartShare * peak.value;
  std::size_t first = begin, last = end - 1;
  while (first < peak.at && speeds[first] < of_part) ++first;
  while (last > peak.at && speeds[last] < of_part) --last;
  while (first > begin && speeds[first - 1] >= least) --first;
  while (last + 1 < end && speeds[last + 1] >= least) ++last;
  // Where the speed is `least`, between this sample and the one outside: on the parabola through
  // both and the next one inside.
  const auto passage_s = [&](std::size_t inside, std::size_t outside) {
    const std::size_t within = inside < outside ? inside - 1 : inside + 1;
    const double fall = speeds[inside] - speeds[outside];
    const double curve =
        within < speeds.size() ? (speeds[within] - 2 * speeds[inside] + speeds[outside]) / 2 : 0;
    double share = 0.5;
    for (int i = 0; i < 4; ++i) {
      share = std::clamp((speeds[inside] - least - curve * share * (1 - share)) / fall, 0.0, 1.0);
    }
    return time_s[inside] + share * (time_s[outside] - time_s[inside]);
  };
  return {peak.value, first > begin ? passage_s(first, first - 1) : time_s[first],
          last + 1 < end ? passage_s(last, last + 1) : time_s[last]};
}

void add_opening(const JawPath& path, const std::vector<double>& distances_m,
                 const Greatest& farthest, double turning_sd_rad_s, ReadingValues& out) {
  const std::size_t turn = farthest.at;
  out.add_top(top_of(path, sizes_of(path.incisor_m)), kMillimetre);
  out.add_top(top_of(path, coordinate_of(path.incisor_m, 2, -1)), kMillimetre);
  std::vector<double> twists;
  for (const Vector3d& w : path.rotation_rad) twists.push_back(twist_about(w, 1));
  const Greatest twist = top_of(path, twists);
  out.add_top(twist, kDegree);
  out.add_at_top(farthest, distances_m,
                 [&](std::size_t k) { return path.incisor_m[k].y() / kMillimetre; });
  double deviation_m = 0;
  const Vector3d chord = path.incisor_m[turn] - path.incisor_m[0];
  for (std::size_t k = 0; k <= turn; ++k) {
    // Sideways of the chord, at the same height.
    const double share =
        chord.z() != 0 ? (path.incisor_m[k].z() - path.incisor_m[0].z()) / chord.z() : 0;
    const double aside_m = path.incisor_m[k].y() - path.incisor_m[0].y() - share * chord.y();
    if (std::abs(aside_m) > std::abs(deviation_m)) deviation_m = aside_m;
  }
  out.add(deviation_m / kMillimetre);
  add_axes(path, twists, twist, turning_sd_rad_s, out);
}

// Returns the doubts about the arc lengths.
std::array<double, 2> add_speeds(const JawPath& path, std::size_t turn, ReadingValues& out) {
  std::array<double, 2> doubts{};
  const std::vector<double> speeds = sizes_of(path.incisor_m_s);
  for (std::size_t back = 0; back < 2; ++back) {
    const std::size_t begin = back == 1 ? turn : 0;
    const std::size_t end = back == 1 ? path.time_s.size() : turn + 1;
    if (end - begin < 5) {
      for (int i = 0; i < 3; ++i) {
        out.add(kNone, [&] {
          return std::string(back == 1 ? "the way back is not recorded"
                                       : "the way out is not recorded");
        });
      }
      continue;
    }
    const Movement movement = movement_of(path, speeds, begin, end);
    out.add(movement.peak_m_s / kMillimetre);
    const Smoothness smoothness =
        smoothness_of(path.time_s, speeds, movement.begin_s, movement.end_s);
    out.add(smoothness.spectral_arc_length);
    out.add(smoothness.log_dimensionless_jerk);
    doubts[back] = smoothness.arc_length_doubt;
  }
  return doubts;
}

}  // namespace

std::vector<StrokeReading> readings_of_stroke(TaskKind kind, bool has_landmarks) {
  std::vector<StrokeReading> names = {{"displacement_mm"}, {"rotation_deg"}};
  if (kind == TaskKind::rest || kind == TaskKind::whole) return names;
  if (kind == TaskKind::border) {
    if (has_landmarks) {
      for (const char* name :
           {"border_area_sagittal_mm2", "border_area_frontal_mm2", "border_area_horizontal_mm2",
            "border_loop_sagittal_mm2", "border_loop_frontal_mm2", "border_loop_horizontal_mm2",
            "border_volume_mm3"}) {
        names.push_back({name});
      }
    }
    return names;
  }
  for (const char* name : {"opening_peak_speed_mm_s", "sparc", "ldlj", "closing_peak_speed_mm_s",
                           "closing_sparc", "closing_ldlj"}) {
    names.push_back({name});
  }
  if (!has_landmarks) {
    if (kind == TaskKind::opening) names.push_back({"opening_mm"});
    return names;
  }
  if (kind == TaskKind::opening) {
    for (const char* name : {"opening_mm", "opening_vertical_mm", "opening_angle_deg",
                             "opening_deflection_mm", "opening_deviation_mm"}) {
      names.push_back({name});
    }
    add_axis_names(names);
  }
  if (kind == TaskKind::protrusion) names.push_back({"protrusion_mm"});
  if (kind == TaskKind::left || kind == TaskKind::right) {
    const bool is_left = kind == TaskKind::left;
    names.push_back({"laterotrusion_mm", is_left ? Side::left : Side::right});
    names.push_back({"yaw_angle_deg", is_left ? Side::left : Side::right});
    names.push_back({"working_shift_mm", is_left ? Side::left : Side::right});
    names.push_back({"working_shift_angle_deg", is_left ? Side::left : Side::right});
  }
  add_condyle_names(kind, names);
  return names;
}

std::vector<std::string_view> names_of(const std::vector<StrokeReading>& readings) {
  std::vector<std::string_view> names;
  for (const StrokeReading& reading : readings) names.push_back(reading.name);
  return names;
}

namespace {

void add_stroke(TaskKind kind, bool has_landmarks, const JawPath& path, double turning_sd_rad_s,
                ReadingValues& out) {
  const std::vector<double> distances = sizes_of(path.incisor_m);
  const double reach_s =
      top_reach_s(path, kind == TaskKind::whole ? kCycleTopReach_s : kTopReach_s);
  const Greatest farthest = greatest_of(path.time_s, distances, 0, distances.size(), reach_s);
  const std::size_t turn = farthest.at;
  out.add_top(farthest, kMillimetre);
  const std::vector<double> angles = sizes_of(path.rotation_rad);
  out.add_top(greatest_of(path.time_s, angles, 0, angles.size(), reach_s), kDegree);
  if (kind == TaskKind::rest || kind == TaskKind::whole) return;
  if (kind == TaskKind::border) {
    if (!has_landmarks) return;
    const ConvexHull hull = convex_hull(path.incisor_m);
    out.add(hull_area(hull.corners, 0, 2) * 1e6);
    out.add(hull_area(hull.corners, 1, 2) * 1e6);
    out.add(hull_area(hull.corners, 0, 1) * 1e6);
    out.add(greatest_loop_m2(path.incisor_m, 0, 2, kReturn_m) * 1e6);
    out.add(greatest_loop_m2(path.incisor_m, 1, 2, kReturn_m) * 1e6);
    out.add(greatest_loop_m2(path.incisor_m, 0, 1, kReturn_m) * 1e6);
    out.add(hull.volume * 1e9);
    return;
  }
  const std::array<double, 2> doubts = add_speeds(path, turn, out);
  const auto add_doubts = [&] {
    for (const double doubt : doubts) out.add(doubt);
  };
  if (!has_landmarks) {
    if (kind == TaskKind::opening) {
      out.add(kNone,
              [] { return std::string("the lower incisor is not known; give --landmarks"); });
      out.keep_shortfall(0);
    }
    add_doubts();
    return;
  }
  if (kind == TaskKind::opening) add_opening(path, distances, farthest, turning_sd_rad_s, out);
  if (kind == TaskKind::protrusion) {
    out.add_top(top_of(path, coordinate_of(path.incisor_m, 0, 1)), kMillimetre);
  }
  if (kind == TaskKind::left || kind == TaskKind::right) {
    const bool is_left = kind == TaskKind::left;
    const std::vector<double> aside = coordinate_of(path.incisor_m, 1, is_left ? 1 : -1);
    const Greatest farthest_aside = top_of(path, aside);
    out.add_top(farthest_aside, kMillimetre);
    std::vector<double> yaws;
    for (const Vector3d& w : path.rotation_rad)
      yaws.push_back((is_left ? 1 : -1) * twist_about(w, 2));
    out.add_top(top_of(path, yaws), kDegree);
    const std::size_t side = is_left ? 0 : 1;
    out.add_at_top(farthest_aside, aside, [&](std::size_t k) {
      return -medial(path.condyle_m[side][k], side) / kMillimetre;
    });
    const auto angle_at = [&](std::size_t k) {
      const Vector3d& working = path.condyle_m[side][k];
      return std::atan2(working.x(), -medial(working, side)) / kDegree;
    };
    out.add_at_top(farthest_aside, aside, [&, at = angle_at(farthest_aside.at)](std::size_t k) {
      return at + std::remainder(angle_at(k) - at, 360);
    });
  }
  const CondylarSeparations separations = add_condyles(kind, path, out);
  add_separations(kind, path, separations, out);
  add_doubts();
}

}  // namespace

void read_stroke(TaskKind kind, bool has_landmarks, const JawPath& path,
                 std::vector<double>& values, std::vector<std::string>* why,
                 double turning_sd_rad_s) {
  ReadingValues out(values, why);
  add_stroke(kind, has_landmarks, path, turning_sd_rad_s, out);
  out.add_shortfalls();
}

void narrow_what_noise_adds(const std::vector<StrokeReading>& names,
                            std::vector<UncertainValue>& values) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view name = names[i].name;
    const bool is_spread = name.ends_with("_spread_mm");
    const bool is_hull = name.starts_with("border_area") || name.starts_with("border_volume");
    if (!is_spread && !is_hull && !name.starts_with("condylar_path")) continue;
    // What noise adds to a length or a hull follows from its variance, which is known to a few
    // percent.
    values[i].scale_corrections(kShareOfSmoothing);
    // The spread of axes is never negative, so that smoothing always adds to it.
    if (is_spread) values[i].doubt = std::hypot(values[i].doubt, kSpreadError_mm);
  }
}

void widen_shift_angle(const std::vector<StrokeReading>& names,
                       std::vector<UncertainValue>& values) {
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (names[i].name != "working_shift_angle_deg") continue;
    const UncertainValue& aside = values[i - 1];
    UncertainValue& angle = values[i];
    if (!std::isfinite(angle.value)) continue;
    const double shift_mm = std::abs(aside.value / std::cos(angle.value * kDegree));
    const double least_mm = shift_mm - aside.half_interval();
    if (!(least_mm > 0)) {
      angle.value = kNone;
      angle.missing = "the condyle's shift may be zero, which has no direction";
      continue;
    }
    const double growth = shift_mm / least_mm;
    angle.doubt = std::hypot(angle.doubt, angle.half_interval() * std::sqrt(growth * growth - 1));
  }
}

}  // namespace condyle::host
