// SPDX-License-Identifier: Apache-2.0
// The change detector over the cycles of a recording.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "condyle/estimator/changes/change_detector.h"
#include "condyle/estimator/changes/cycle_timeline.h"

namespace condyle::host {

/// A cycle, and the detector's state after it.
struct WatchedCycle {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  TimeNs end_ns = 0;
  CycleReport<double> report;
  double statistic_up = kNone, statistic_down = kNone, threshold = kNone;  ///< if it counted
  ChangeState state = ChangeState::learning;
  bool is_watched = true;  ///< false: the point was lost before
};

/// An alarm.
struct DetectedChange {
  DampingChange<double> change;            ///< its cycle numbers are not used
  std::size_t alarm = 0, first_after = 0;  ///< cycles of the recording
  bool is_increase = false;
  /// Apparent change that the stated drive can cause without a real one (Ns/m): by the force that
  /// it misses before and after, and by its delay if the rhythm changed with the damping.
  double of_drive_Ns_m = 0;
  /// False: this may be as large as the detected change.
  bool is_told() const;
};

/// What is assumed.
struct WatchSettings {
  ChangeParameters detector;          ///< its false_alarm_cycles is not used
  double false_alarm_interval_h = 0;  ///< of chewing, between two false alarms
  DriveParameters drive;              ///< its missing share and the uncertainty of its delay
  double mass_kg = 0;                 ///< of the baseline
};

/// A recording's cycles and changes. After an alarm the detector learns again.
struct ChangeWatch {
  std::vector<WatchedCycle> cycles;
  std::vector<DetectedChange> changes;
  /// First cycle from which the point stayed lost (three of ten cycles). This cycle and later ones
  /// are not watched.
  std::optional<std::size_t> lost_from;
  double false_alarm_cycles = 0;  ///< cycles in the interval; may be out of range
  std::size_t counted = 0, judged = 0;
  double mean_duration_s = 0;         ///< of the counted ones, like the following
  double mean_Ns_m = 0, sd_Ns_m = 0;  ///< weighted mean; stated sd of a cycle, rms
  double spread = 1;                  ///< ChangeDetector's, at the end
  double of_drive_Ns_m = 0;           ///< as in DetectedChange, without a change of the rhythm
};

/// Runs the detector; judges no cycle if `false_alarm_cycles` is out of range.
ChangeWatch watch_cycles(const std::vector<TimedCycle<double>>& cycles,
                         const WatchSettings& settings);

/// Number of cycles of `outcome`.
std::size_t count_of(const ChangeWatch& watch, CycleOutcome outcome);

/// Cycles until the alarm, of 400 simulated changes.
struct DetectionDelay {
  std::size_t after_cycles = 0;        ///< from which it had learned
  std::optional<double> median, most;  ///< half of them, nine of ten; else longer than kLongest
  static constexpr int kLongest = 1000;
};

/// How soon a change of `change_Ns_m` would be detected among cycles that scatter like those of
/// `watch`, if it comes after half of them, but after at least the detector's baseline_cycles and
/// at most 390.
DetectionDelay expected_delay(const ChangeWatch& watch, const ChangeParameters& detector,
                              double change_Ns_m);

}  // namespace condyle::host
