// SPDX-License-Identifier: Apache-2.0
#include "changes/change_watch.h"

#include <algorithm>
#include <cmath>

#include "statistics/random.h"

namespace condyle::host {
namespace {

ChangeParameters detector_of(const ChangeParameters& parameters, double false_alarm_cycles) {
  ChangeParameters result = parameters;
  result.false_alarm_cycles = false_alarm_cycles;
  return result;
}

bool counts(const WatchedCycle& cycle) {
  return cycle.is_watched && cycle.report.outcome == CycleOutcome::counted;
}

// Means over the counted cycles of a range.
struct Stretch {
  double drive_per_velocity_Ns_m = 0, rhythm2_rad2_s2 = 0;
};

Stretch stretch_of(const std::vector<WatchedCycle>& cycles, std::size_t begin, std::size_t end) {
  Stretch sum;
  double count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const CycleReport<double>& report = cycles[i].report;
    if (!counts(cycles[i])) continue;
    sum.drive_per_velocity_Ns_m += report.drive_per_velocity_Ns_m;
    sum.rhythm2_rad2_s2 += report.rhythm_rad_s * report.rhythm_rad_s;
    ++count;
  }
  if (count == 0) return {};
  return {sum.drive_per_velocity_Ns_m / count, sum.rhythm2_rad2_s2 / count};
}

double of_drive(const WatchSettings& settings, const Stretch& before, const Stretch& after) {
  const double missing = missing_over_measured(settings.drive.missing_share) *
                         (before.drive_per_velocity_Ns_m + after.drive_per_velocity_Ns_m);
  const double delay = settings.mass_kg * settings.drive.delay_sd_s *
                       std::abs(after.rhythm2_rad2_s2 - before.rhythm2_rad2_s2);
  return missing + kNormalQuantile95 * delay;
}

void look_for_loss(ChangeWatch& watch) {
  constexpr std::size_t kAmong = 10;
  constexpr int kMost = 2;
  for (std::size_t i = 0; i < watch.cycles.size() && !watch.lost_from; ++i) {
    int lost = 0;
    for (std::size_t j = i; j < std::min(i + kAmong, watch.cycles.size()); ++j) {
      lost += watch.cycles[j].report.outcome == CycleOutcome::lost ? 1 : 0;
    }
    if (lost > kMost && watch.cycles[i].report.outcome == CycleOutcome::lost) watch.lost_from = i;
  }
  for (std::size_t i = watch.lost_from.value_or(watch.cycles.size()); i < watch.cycles.size();
       ++i) {
    watch.cycles[i].is_watched = false;
  }
}

void summarise(ChangeWatch& watch) {
  WeightedMean<double> mean;
  double squares = 0;
  for (const WatchedCycle& cycle : watch.cycles) {
    if (!counts(cycle)) continue;
    const double variance = cycle.report.standard_deviation * cycle.report.standard_deviation;
    ++watch.counted;
    mean.add(cycle.report.friction_Ns_m, 1 / variance);
    squares += variance;
    watch.mean_duration_s += cycle.report.duration_s;
  }
  if (watch.counted == 0) return;
  const auto n = static_cast<double>(watch.counted);
  watch.mean_duration_s /= n;
  watch.mean_Ns_m = mean.mean;
  watch.sd_Ns_m = std::sqrt(squares / n);
}

}  // namespace

bool DetectedChange::is_told() const {
  return std::abs(change.after_Ns_m - change.before_Ns_m) -
             kNormalQuantile95 * std::hypot(change.after_sd, change.before_sd) >
         of_drive_Ns_m;
}

ChangeWatch watch_cycles(const std::vector<TimedCycle<double>>& cycles,
                         const WatchSettings& settings) {
  ChangeWatch watch;
  for (const auto& [end_ns, report] : cycles) watch.cycles.push_back({end_ns, report});
  look_for_loss(watch);
  summarise(watch);
  const Stretch all = stretch_of(watch.cycles, 0, watch.cycles.size());
  watch.of_drive_Ns_m = of_drive(settings, all, all);
  constexpr double kSecondsPerHour = 3600;
  watch.false_alarm_cycles =
      kSecondsPerHour * settings.false_alarm_interval_h / watch.mean_duration_s;
  const ChangeParameters parameters = detector_of(settings.detector, watch.false_alarm_cycles);
  if (!is_valid(parameters)) return watch;

  ChangeDetector<double> detector(parameters);
  std::vector<std::size_t> learned;  // which cycles the detector knows
  std::size_t begin = 0;             // of them
  for (std::size_t i = 0; i < watch.cycles.size(); ++i) {
    WatchedCycle& cycle = watch.cycles[i];
    if (counts(cycle)) {
      detector.add(cycle.report.friction_Ns_m, cycle.report.standard_deviation);
      learned.push_back(i);
      if (detector.state() != ChangeState::learning) {
        ++watch.judged;
        cycle.statistic_up = detector.statistic_up();
        cycle.statistic_down = detector.statistic_down();
        cycle.threshold = detector.threshold();
      }
      watch.spread = detector.spread();
    }
    cycle.state = detector.state();
    if (!detector.is_alarm()) continue;
    DetectedChange found{detector.change(), i,
                         learned[static_cast<std::size_t>(detector.change().first_after)],
                         detector.state() == ChangeState::increased, 0};
    found.of_drive_Ns_m = of_drive(settings, stretch_of(watch.cycles, begin, found.first_after),
                                   stretch_of(watch.cycles, found.first_after, i + 1));
    watch.changes.push_back(found);
    detector.reset();
    learned.clear();
    begin = i + 1;
  }
  return watch;
}

std::size_t count_of(const ChangeWatch& watch, CycleOutcome outcome) {
  return static_cast<std::size_t>(std::count_if(
      watch.cycles.begin(), watch.cycles.end(),
      [outcome](const WatchedCycle& cycle) { return cycle.report.outcome == outcome; }));
}

DetectionDelay expected_delay(const ChangeWatch& watch, const ChangeParameters& detector,
                              double change_Ns_m) {
  constexpr std::size_t kRuns = 400;
  constexpr double kMostLearned = 390;  // more cycles hardly help
  ChangeParameters parameters = detector_of(detector, watch.false_alarm_cycles);
  parameters.baseline_cycles = std::min(parameters.baseline_cycles, kMostLearned);
  DetectionDelay result;
  result.after_cycles = static_cast<std::size_t>(
      std::clamp(static_cast<double>(watch.counted) / 2, parameters.baseline_cycles, kMostLearned));
  const double sd_Ns_m = watch.sd_Ns_m * watch.spread;
  std::vector<int> delays;
  for (std::uint64_t run = 0; delays.size() < kRuns; ++run) {
    RandomGenerator random(1, run);
    ChangeDetector<double> simulated(parameters);
    const auto add = [&](double shift_Ns_m) {
      simulated.add(shift_Ns_m + sd_Ns_m * random.normal(), watch.sd_Ns_m);
    };
    for (std::size_t i = 0; i < result.after_cycles; ++i) add(0);
    if (simulated.is_alarm()) continue;  // a false alarm
    int delay = 0;
    while (!simulated.is_alarm() && delay <= DetectionDelay::kLongest) {
      add(change_Ns_m);
      ++delay;
    }
    delays.push_back(delay);
  }
  std::sort(delays.begin(), delays.end());
  const auto at = [&](std::size_t i) {
    return delays[i] <= DetectionDelay::kLongest ? std::optional<double>(delays[i]) : std::nullopt;
  };
  result.median = at(kRuns / 2);
  result.most = at(kRuns * 9 / 10);
  return result;
}

}  // namespace condyle::host
