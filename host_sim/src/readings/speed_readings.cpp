// SPDX-License-Identifier: Apache-2.0
#include "readings/speed_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "readings/path_measures.h"
#include "readings/peak_speed.h"
#include "readings/reading_groups.h"
#include "readings/stroke_readings.h"

namespace condyle::host {
namespace {

// Of a cycle: the noise of many cycles averages, what a wider window hides does not.
constexpr double kWidestOfCycle_s = 0.1;

// Where a stroke of these displacements is farthest, as a sample of the recording.
std::size_t farthest_of(const JawPath& path, const Points& points, SampleRun stroke,
                        bool is_sagittal) {
  std::vector<double> time_s, distances;
  for (std::size_t k = stroke.begin; k < stroke.end; ++k) {
    time_s.push_back(path.time_s[k]);
    distances.push_back(is_sagittal ? std::hypot(points[k].x(), points[k].z()) : points[k].norm());
  }
  return stroke.begin + greatest_of(time_s, distances, 0, distances.size(), kTopReach_s).at;
}

// A speed that the smoothed path has, or not for a reason, is read anew.
void replace(UncertainValue& value, const UncertainValue& speed) {
  if (std::isfinite(value.value) || value.missing.empty()) value = speed;
}

// Hides what short movements decide on, if a sample of `run` was not used that may be one.
void hide_beside_jumps(const ReferredMotion& motion, SampleRun run,
                       const std::vector<std::string_view>& names,
                       std::vector<UncertainValue>& values) {
  const auto jump_s = first_jump_s(motion, run.begin, run.end);
  if (!jump_s) return;
  for (std::size_t i = 0; i < names.size() && i < values.size(); ++i) {
    if (!is_of_short_movements(names[i]) || !std::isfinite(values[i].value)) continue;
    values[i].value = JawReading::kNone;
    values[i].is_hidden = true;
    values[i].missing = fmt::format(
        "samples at {:.2f} s jump away from the path and are not used, but a jaw may move so",
        *jump_s);
  }
}

}  // namespace

void read_speeds_of_stroke(const std::vector<StrokeReading>& names, const JawPath& path,
                           SampleRun stroke, const TaskContext& context,
                           std::vector<UncertainValue>& values) {
  SpeedReader reader(*context.motion, stroke, *context.noise, context.errors, PathPart::all);
  const std::size_t turn = farthest_of(path, path.incisor_m, stroke, false);
  for (std::size_t i = 0; i < names.size() && i < values.size(); ++i) {
    const std::string_view name = names[i].name;
    if (name == "opening_peak_speed_mm_s") {
      replace(values[i], reader.greatest(SpeedPoint::incisor, {stroke.begin, turn + 1}, 0));
    } else if (name == "closing_peak_speed_mm_s") {
      replace(values[i], reader.greatest(SpeedPoint::incisor, {turn, stroke.end}, 0));
    } else if (name == "condylar_peak_speed_mm_s") {
      const bool is_left = names[i].side == Side::left;
      const std::size_t end = farthest_of(path, path.condyle_m[is_left ? 0 : 1], stroke, true);
      replace(values[i],
              reader.greatest(is_left ? SpeedPoint::condyle_left : SpeedPoint::condyle_right,
                              {stroke.begin, end + 1}, 0));
    }
  }
  hide_beside_jumps(*context.motion, stroke, names_of(names), values);
}

void read_speeds_of_cycle(const ChewingCycle& cycle, const TaskContext& context,
                          std::vector<UncertainValue>& values) {
  SpeedReader reader(*context.motion, {cycle.begin, cycle.end + 1}, *context.noise, context.errors,
                     PathPart::incisor, kWidestOfCycle_s);
  const auto names = readings_of_cycle(context.has_landmarks);
  const SampleRun out{cycle.begin, cycle.turn + 1}, back{cycle.turn, cycle.end + 1};
  for (std::size_t i = 0; i < names.size() && i < values.size(); ++i) {
    if (names[i] == "opening_peak_speed_mm_s") {
      replace(values[i], reader.greatest(SpeedPoint::incisor, out, 0));
    } else if (names[i] == "closing_peak_speed_mm_s") {
      replace(values[i], reader.greatest(SpeedPoint::incisor, back, 0));
    } else if (names[i] == "opening_peak_vertical_speed_mm_s") {
      replace(values[i], reader.greatest(SpeedPoint::incisor, out, -1));
    } else if (names[i] == "closing_peak_vertical_speed_mm_s") {
      replace(values[i], reader.greatest(SpeedPoint::incisor, back, 1));
    }
  }
  hide_beside_jumps(*context.motion, {cycle.begin, cycle.end + 1}, names, values);
}

}  // namespace condyle::host
