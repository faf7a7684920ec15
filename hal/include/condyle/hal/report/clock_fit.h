// SPDX-License-Identifier: Apache-2.0
// When, on the host's clock, did the device measure? Reports carry the device's time d and arrive
// at h, which jitters: by the bus's polling, by a busy host, by bursts. Delays are never negative,
// so the earliest arrivals show how the two clocks lie to each other.
//
//   r = (h - h_0) - (d - d_0)     drift since the first report, plus the delay (ns)
//   r_k, d_k                      least r of second k, and when: what little delay there is at
//   least b     drift: median of the slopes between all pairs of (d_k, r_k) of the last 16 seconds
//         (Theil-Sen; P. K. Sen, J. Am. Stat. Assoc. 63 (1968) 1379-1389)
//   a     offset: median of r_k - b d_k
//   o     offset in use; goes to a + b d no faster than kSlew per device time beyond b, so that
//         the time between samples is never distorted by more
//   time  h_0 + (d - d_0) + o     the instant of measurement plus the least delay
//
// Before the first second is complete, least r so far stands for a and b = 0. The same reports give
// the same times, live and from a log.
//
// Where one clock stepped against the other by more than kStep_ns, the fit starts anew: a device
// that is ahead of what its arrivals allow, at once; one that fell behind, once four seconds in a
// row are late by the same, for until then they may only have been held up. Smaller steps are
// slewed. A delay that all reports of eight seconds share cannot be told from a smaller step.
#pragma once

#include <array>
#include <cstdint>

#include "condyle/estimator/sample.h"

namespace condyle::hal {

/// Effect of a report on the fit.
enum class FitOutcome : std::uint8_t {
  started,      ///< the first one, or the first after restart()
  followed,     ///< the clocks continued together
  ran_ahead,    ///< the device's clock leapt ahead, or the host's stopped: the fit starts again
  fell_behind,  ///< the device's clock stopped, or the host's leapt ahead: the fit starts again
  went_back,    ///< the device's time is before the last one: the fit starts again
};

/// Name of an outcome in messages.
constexpr const char* outcome_name(FitOutcome outcome) {
  constexpr const char* names[] = {"started", "followed", "ran ahead", "fell behind", "went back"};
  return names[static_cast<int>(outcome)];
}

/// How a time is tied to the host's clock.
enum class TimeProvenance : std::uint8_t {
  host_arrival,  ///< the arrival of the first report, or an earlier arrival since: nothing is
                 ///< fitted
  device_clock,  ///< the fit
};

/// Maps the unwrapped time of a device (see DeviceClock) to the host's clock. Constant memory, no
/// allocation.
class ClockFit {
 public:
  /// Host time of the measurement at `device_ns` that arrived at `arrival_ns`. Never before the
  /// previous one; equal if both have the same device time. Until the fit has its first second, the
  /// result is the first report's arrival plus the device's own steps, so that the time between
  /// samples does not jitter at the start.
  TimeNs add(TimeNs device_ns, TimeNs arrival_ns);

  /// The device's clock was set or restarted: its times are unrelated to those before.
  void restart() { has_origin_ = false; }

  /// Effect of the last report.
  FitOutcome outcome() const { return outcome_; }
  /// How often the fit restarted by itself.
  std::uint64_t steps() const { return steps_; }
  /// How the last time is tied to the host's clock.
  TimeProvenance provenance() const {
    return count_ > 0 ? TimeProvenance::device_clock : TimeProvenance::host_arrival;
  }
  /// Seconds in the fit, at most 16; 0 while it is only the earliest arrival so far.
  int seconds_fitted() const { return count_; }
  /// The last time minus the device's (ns).
  TimeNs offset_ns() const;
  /// Time that passed on the device's clock for each second of the host's, since the first report;
  /// 0 before two seconds have passed. Far from 1 if the profile states the wrong unit for the
  /// clock; all times are then wrong.
  double pace() const;
  /// How much slower the device's clock runs than the host's, parts per million.
  double drift_ppm() const { return drift_ * 1e6; }
  /// Uncertainty of drift_ppm(): one standard deviation, from the spread of the earliest arrivals
  /// and from the frames of 1 ms for which reports wait on a full-speed bus (USB 2.0, section
  /// 5.7.4). The frames beat with the device's clock so slowly that their part of the drift cannot
  /// be seen. Infinite before three seconds are fitted.
  double drift_uncertainty_ppm() const;
  /// Spread of the earliest arrivals around the fit: one standard deviation (s), robust.
  double residual_s() const { return residual_ns_ * 1e-9; }
  /// Remaining difference between the offset in use and the fitted one (s).
  double pending_s() const { return pending_ns_ * 1e-9; }
  /// Uncertainty of the last time, relative to the instant of measurement plus the least delay (s):
  /// one standard deviation from the spread of the earliest arrivals, the remaining offset, and a
  /// suspected step: reports that are earlier than the fit allows, or a whole second that is later.
  /// The least delay itself cannot be seen from here.
  double uncertainty_s() const;

 private:
  static constexpr int kWindow = 16;         // seconds
  static constexpr double kSecond_ns = 1e9;  // of device time
  static constexpr double kSlew = 1e-3;
  static constexpr double kStep_ns = 1e8;
  static constexpr double kWander = 2e-4;  // of drift, before anything is fitted
  static constexpr double kSuspected = 4;  // spreads away from the line: perhaps a step
  static constexpr int kLateSeconds = 4;   // in a row: then it was a step
  static constexpr double kFrame_ns = 1e6;
  static constexpr double kUnseen_ns = 1e6;  // spread assumed for delays not seen yet

  // The times of the seconds' earliest arrivals: their mean, and the sum of squares about it.
  struct Spread {
    double mean = 0, square = 0;
  };
  Spread seconds_spread() const;
  double arrival_spread_ns() const;
  void begin(TimeNs device_ns, TimeNs host_ns, FitOutcome outcome);
  void begin_second(double device, double r, TimeNs arrival_ns);
  bool complete_second(TimeNs arrival_ns);
  bool is_late(TimeNs arrival_ns);
  void fit();
  double line(double device) const { return offset_ns_ + drift_ * device; }
  double tolerance(double device) const;

  bool has_origin_ = false, has_time_ = false;
  FitOutcome outcome_ = FitOutcome::started;
  std::uint64_t steps_ = 0;
  // Since the very first report, ns; without steps and restarts.
  double device_run_ns_ = 0, host_run_ns_ = 0;
  TimeNs last_arrival_ns_ = 0;
  TimeNs device_origin_ns_ = 0, host_origin_ns_ = 0;  // d_0, h_0
  TimeNs last_device_ns_ = 0, last_time_ns_ = 0;
  // The rest (ns) counts from the origin. The second being collected:
  double second_begin_ns_ = 0, least_r_ns_ = 0, least_device_ns_ = 0, largest_r_ns_ = 0;
  TimeNs second_arrival_ns_ = 0;
  // The complete seconds.
  std::array<double, kWindow> least_r_{}, least_d_{};
  int count_ = 0, next_ = 0;
  double newest_d_ns_ = 0, newest_r_ns_ = 0;
  double newest_away_ns_ = 0;  // of the newest second from the line
  // Consecutive late seconds, and how late they were.
  int late_count_ = 0;
  double least_late_ns_ = 0, most_late_ns_ = 0;
  double offset_ns_ = 0, drift_ = 0;  // a, b
  double in_use_ns_ = 0;              // o
  double residual_ns_ = 0, pending_ns_ = 0;
};

}  // namespace condyle::hal
