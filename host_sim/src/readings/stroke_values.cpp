// SPDX-License-Identifier: Apache-2.0
#include "readings/stroke_values.h"

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "readings/analysis_stop.h"
#include "readings/axis_readings.h"
#include "readings/condyle_readings.h"
#include "readings/cycle_values.h"
#include "readings/local_fit.h"
#include "readings/shortfalls.h"
#include "readings/smoothness.h"
#include "readings/speed_readings.h"
#include "readings/stroke_checks.h"
#include "readings/stroke_readings.h"
#include "readings/strokes.h"
#include "statistics/in_blocks.h"

namespace condyle::host {
namespace {

// Of random numbers: those of cycles lie below.
constexpr std::uint64_t kSeed = 20, kFirstStreamOfStrokes = 1ULL << 32;
constexpr int kStrokePairs = 40;
constexpr double kCalmStroke_s = 0.16, kMildStroke_s = 0.2, kLongestGap_s = 0.15;
constexpr std::size_t kLongStroke = 20'000;  // samples

StrokeValues values_of(TaskKind kind, SampleRun stroke, const Analysis& analysis,
                       const TaskContext& context) {
  RandomGenerator random(kSeed, kFirstStreamOfStrokes + stroke.begin);
  const auto names = readings_of_stroke(kind, context.has_landmarks);
  StrokeValues read{stroke, std::vector<UncertainValue>(names.size())};
  const double gap_s = longest_gap_s(analysis.path.time_s, stroke.begin, stroke.end);
  const bool is_long = stroke.end - stroke.begin > kLongStroke;
  std::string problem;
  const bool is_too_short = stroke.end < stroke.begin + 5;
  if (is_too_short) problem = "it has fewer than five usable samples";
  if (gap_s > kLongestGap_s) problem = fmt::format("a gap of {:.2f} s", gap_s);
  const bool is_stroke = kind == TaskKind::opening || kind == TaskKind::protrusion ||
                         kind == TaskKind::left || kind == TaskKind::right;
  if (is_stroke && problem.empty()) {
    problem = problem_of_stroke(kind, context.has_landmarks, analysis.path, stroke);
  }
  if (!context.unusable.empty()) problem = context.unusable;
  if (is_too_short || (!problem.empty() && kind != TaskKind::whole)) {
    for (UncertainValue& value : read.values) value.missing = problem;
    return read;
  }
  const double turning_sd_rad_s = context.noise->rotation_sd_rad() * slope_gain(analysis.rate_Hz);
  ReferredMotion near_greatest;
  const bool is_greatest_only = kind == TaskKind::rest || kind == TaskKind::whole;
  const ReferredMotion* motion = context.motion;
  if (is_long && is_greatest_only) {
    near_greatest = near_greatest_of(analysis.path, *motion, *context.noise, stroke);
    motion = &near_greatest;
    stroke = {0, motion->time_s.size()};
  }
  const bool is_still_long = stroke.end - stroke.begin > kLongStroke;
  // A whole recording may contain chewing, which turns as sharply as in its cycles.
  const bool is_whole = kind == TaskKind::whole;
  std::vector<UncertainValue>& values = read.values;
  values = uncertain_values(
      *motion, stroke.begin, stroke.end, *context.noise, context.errors,
      {is_still_long ? 4 : kStrokePairs, is_whole ? kCalmCycle_s : kCalmStroke_s,
       is_whole ? kMildCycle_s : kMildStroke_s, PathPart::all,
       is_whole ? kTimesSmoothingOfCycle : 2},
      random, [&](const JawPath& path, std::vector<double>& into, std::vector<std::string>* why) {
        read_stroke(kind, context.has_landmarks, path, into, why, turning_sd_rad_s);
      });
  take_shortfalls(names_of(names), values);
  if (is_stroke) {
    const auto doubts = take_arc_length_doubts(values);
    for (std::size_t k = 0; k < names.size(); ++k) {
      widen_smoothness(names[k].name, doubts, context.noise->shared, values[k]);
    }
  }
  if (values.size() > names.size()) finish_separations(names, values);
  narrow_what_noise_adds(names, values);
  hide_unknown_axes(names, values);
  widen_shift_angle(names, values);
  if (is_stroke) read_speeds_of_stroke(names, analysis.path, stroke, context, values);
  const std::string onset =
      is_stroke && context.has_landmarks ? problem_of_onset(analysis.path, stroke) : "";
  if (!onset.empty()) withhold_condyles(names, onset, values);
  read.has_onset = is_stroke && onset.empty();
  return read;
}

}  // namespace

std::vector<StrokeValues> values_of_strokes(TaskKind kind, const std::vector<SampleRun>& strokes,
                                            const Analysis& analysis, const TaskContext& context) {
  std::vector<StrokeValues> all(strokes.size());
  run_in_blocks(strokes.size(), 1, [&](std::size_t index, std::size_t) {
    stop_if_asked(context.should_stop);
    all[index] = values_of(kind, strokes[index], analysis, context);
  });
  return all;
}

}  // namespace condyle::host
