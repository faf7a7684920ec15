// SPDX-License-Identifier: Apache-2.0
#include "readings/cycle_values.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "readings/analysis_stop.h"
#include "readings/shortfalls.h"
#include "readings/smoothness.h"
#include "readings/speed_readings.h"
#include "statistics/chi_square.h"
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
// Farther from where the cycle was found to turn, the jaw may turn in another of its openings.
constexpr double kUnknownTurn_s = 0.2;
constexpr double kUnbounded = 1e9;  // more than any time (s) or speed (mm/s)
// Error of the instant of a top between samples, whose jerk changes there, over step^2 / time to
// the next turn.
constexpr double kBetweenSamples = 1.4;

// When the jaw turns: from its begin or from its end, whichever is known better.
Interval turn_of(const ChewingCycle& cycle, const std::vector<std::string_view>& names,
                 const std::vector<UncertainValue>& values) {
  Interval turn_s{-kUnbounded, kUnbounded};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_opening = names[i] == "opening_time_s";
    if (!is_opening && names[i] != "closing_time_s") continue;
    if (!std::isfinite(values[i].value)) continue;
    const double half_s = values[i].half_interval();
    const double middle_s =
        is_opening ? cycle.begin_s + values[i].value : cycle.end_s - values[i].value;
    if (half_s < (turn_s.high - turn_s.low) / 2) turn_s = {middle_s - half_s, middle_s + half_s};
  }
  return turn_s;
}

// The peak speeds, where the jaw may turn at any time in `turn_s`. They are hidden if they depend
// on it.
void read_speeds_of_unknown_turn(const ChewingCycle& cycle, Interval turn_s,
                                 const TaskContext& context, std::vector<UncertainValue>& values) {
  const auto names = readings_of_cycle(context.has_landmarks);
  const std::vector<UncertainValue> smoothed = values;
  read_speeds_of_cycle(cycle, context, values);
  std::vector<double> changes(names.size(), 0);
  const auto& time_s = context.motion->time_s;
  for (const double end_s : {turn_s.low, turn_s.high}) {
    ChewingCycle moved = cycle;
    moved.turn = cycle.begin;
    while (moved.turn + 1 < cycle.end && time_s[moved.turn] < end_s) ++moved.turn;
    std::vector<UncertainValue> other = smoothed;
    read_speeds_of_cycle(moved, context, other);
    for (std::size_t i = 0; i < names.size(); ++i) {
      changes[i] = std::max(changes[i], std::abs(other[i].value - values[i].value));
      if (!std::isfinite(other[i].value)) changes[i] = kUnbounded;
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].find("_peak_") == std::string_view::npos || !std::isfinite(values[i].value)) {
      continue;
    }
    if (changes[i] <= values[i].half_interval() / 2) {
      values[i].doubt = std::hypot(values[i].doubt, changes[i]);
      continue;
    }
    values[i].value = JawReading::kNone;
    values[i].is_hidden = true;
    values[i].missing = "it depends on when the jaw turns, which is not known to 0.2 s";
  }
}

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
  const Interval turn_s = turn_of(cycle, names, values);
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
    widen_smoothness(name, doubts, context.noise->shared, values[i]);
    if (has_begin) values[i].noise_sd = std::hypot(values[i].noise_sd, at_begin_s);
    if (has_end) values[i].noise_sd = std::hypot(values[i].noise_sd, at_end_s);
  }
  if (turn_s.low >= cycle.turn_s - kUnknownTurn_s && turn_s.high <= cycle.turn_s + kUnknownTurn_s) {
    read_speeds_of_cycle(cycle, context, values);
  } else {
    read_speeds_of_unknown_turn(cycle, turn_s, context, values);
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
