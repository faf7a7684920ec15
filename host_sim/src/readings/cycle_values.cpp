// SPDX-License-Identifier: Apache-2.0
#include "readings/cycle_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "readings/analysis_stop.h"
#include "readings/shortfalls.h"
#include "readings/smoothness.h"
#include "readings/speed_readings.h"
#include "statistics/monte_carlo.h"

namespace condyle::host {
namespace {

constexpr std::uint64_t kSeed = 20, kFirstStream = 2;
constexpr int kPairs = 12;
// Of LDLJ: a calm path shows hardly any of the jerk.
constexpr double kTimesJerk = 5;
// What is read before and after a cycle: noise moves closed times by less than the last one.
constexpr double kMargin_s = 0.15, kMarginAtPause_s = 0.3, kMarginOfClosed_s = 0.05;
// Standard deviation of the instant at which the jaw leaves or reaches a pause: it begins and ends
// so slowly that its form, which is not known, decides.
constexpr double kPauseBoundary_s = 8e-3;
// Half interval of the opening time above which the jaw may turn in another opening of the cycle.
constexpr double kUnknownTurn_s = 0.2;
// Error of the instant of a top between samples, whose jerk changes there, over step^2 / time to
// the next turn.
constexpr double kBetweenSamples = 1.4;

std::vector<UncertainValue> values_of(const CycleToRead& read, const TaskContext& context,
                                      std::uint64_t stream) {
  const ChewingCycle& cycle = read.cycle;
  const auto& time_s = context.motion->time_s;
  std::size_t begin = cycle.begin, end = cycle.end + 1;
  const double earliest_s =
      std::min(time_s[cycle.begin] - (cycle.begins.is_pause ? kMarginAtPause_s : kMargin_s),
               cycle.begins.reads_s - kMarginOfClosed_s);
  const double latest_s =
      std::max(time_s[cycle.end] + (cycle.ends.is_pause ? kMarginAtPause_s : kMargin_s),
               cycle.ends.reads_s + kMarginOfClosed_s);
  while (begin > 0 && time_s[begin - 1] >= earliest_s) --begin;
  while (end < time_s.size() && time_s[end] <= latest_s) ++end;
  const std::vector<double> times_s(time_s.begin() + static_cast<std::ptrdiff_t>(begin),
                                    time_s.begin() + static_cast<std::ptrdiff_t>(end));
  const GreatestAt greatest(times_s, kCycleTopReach_s);
  RandomGenerator random(kSeed, stream);
  auto values = uncertain_values(
      *context.motion, begin, end, *context.noise, context.errors,
      {kPairs, kCalmCycle_s, kMildCycle_s, PathPart::incisor, kTimesSmoothingOfCycle}, random,
      [&](const JawPath& path, std::vector<double>& into, std::vector<std::string>* why) {
        read_cycle(cycle, begin, read.height_sd_m, context.has_landmarks, path, greatest, into,
                   why);
      });
  const auto names = readings_of_cycle(context.has_landmarks);
  const auto opening = std::find(names.begin(), names.end(), "opening_time_s") - names.begin();
  const UncertainValue& opening_s = values[static_cast<std::size_t>(opening)];
  const bool knows_turn =
      opening_s.half_interval() <= kUnknownTurn_s &&
      std::abs(cycle.begin_s + opening_s.value - cycle.turn_s) <= kUnknownTurn_s;
  const double stamp_s = context.noise->stamp_sd_s;
  const double at_begin_s = cycle.begins.is_pause ? std::max(kPauseBoundary_s, cycle.begins.sd_s)
                                                  : std::hypot(cycle.begins.sd_s, stamp_s);
  const double at_end_s = cycle.ends.is_pause ? std::max(kPauseBoundary_s, cycle.ends.sd_s)
                                              : std::hypot(cycle.ends.sd_s, stamp_s);
  const double step_s =
      (time_s[cycle.end] - time_s[cycle.begin]) / static_cast<double>(cycle.end - cycle.begin);
  take_shortfalls(names, values);
  const auto doubts = take_arc_length_doubts(values);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view name = names[i];
    const bool has_begin = name == "cycle_duration_s" || name == "opening_time_s";
    const bool has_end =
        name == "cycle_duration_s" || name == "closing_time_s" || name == "slow_close_time_s";
    if (name == "opening_time_s" || name == "closing_time_s") {
      values[i].doubt = kBetweenSamples * step_s * step_s / values[i].value;
    }
    // Where in a closed time the middle lies depends on how the subject closes, in every cycle.
    if (name == "opening_time_s" && !cycle.begins.is_pause) {
      values[i].doubt = std::hypot(values[i].doubt, cycle.begins.sd_s);
    }
    if ((name == "closing_time_s" || name == "slow_close_time_s") && !cycle.ends.is_pause) {
      values[i].doubt = std::hypot(values[i].doubt, cycle.ends.sd_s);
    }
    if (name.ends_with("ldlj")) values[i].scale_corrections(kTimesJerk);
    widen_smoothness(name, doubts, values[i]);
    if (has_begin) values[i].noise_sd = std::hypot(values[i].noise_sd, at_begin_s);
    if (has_end) values[i].noise_sd = std::hypot(values[i].noise_sd, at_end_s);
  }
  read_speeds_of_cycle(cycle, context, values);
  for (std::size_t i = 0; i < names.size() && !knows_turn; ++i) {
    if (names[i].find("_peak_") == std::string_view::npos) continue;
    values[i].value = JawReading::kNone;
    values[i].is_hidden = true;
    values[i].missing = "when the jaw turns is not known to 0.2 s";
  }
  return values;
}

}  // namespace

std::vector<std::vector<UncertainValue>> values_of_cycles(const std::vector<CycleToRead>& cycles,
                                                          const TaskContext& context,
                                                          unsigned threads) {
  std::vector<std::vector<UncertainValue>> all;
  all.reserve(cycles.size());
  MonteCarloControl control;
  control.threads = threads;
  run_monte_carlo(
      cycles.size(), 0,
      [&](std::uint64_t index) {
        stop_if_asked(context.should_stop);
        return values_of(cycles[static_cast<std::size_t>(index)], context, kFirstStream + index);
      },
      [&all](std::vector<UncertainValue> values) { all.push_back(std::move(values)); }, {},
      control);
  return all;
}

}  // namespace condyle::host
