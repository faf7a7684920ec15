// SPDX-License-Identifier: Apache-2.0
// A device's counter and clock wrap. Here they become a count and a time that do not.
#pragma once

#include <cstdint>

#include "condyle/estimator/sample.h"
#include "condyle/hal/report/report_layout.h"

namespace condyle::hal {

/// What a counter shows about a report.
enum class SequenceOutcome : std::uint8_t {
  first,
  next,
  lost,
  duplicated,
  restarted,
  unknown_loss
};

/// A report's place in the sequence of its device.
struct SequenceStep {
  SequenceOutcome outcome = SequenceOutcome::first;
  std::uint64_t sequence = 0;  ///< 0 for the first; lost reports are counted
  std::uint64_t lost = 0;      ///< missed since the previous one
};

/// Unwraps a counter. It detects losses of less than half of its values; a count further ahead
/// counts as one that went back. Longer losses are detected from the host's time, with unknown
/// length, if the rate is known.
class SequenceCounter {
 public:
  /// `rate_Hz`: of the reports; 0: not known. `restarts_on_reconnect`: see ReportContent.
  SequenceCounter(const CountingField& field, double rate_Hz, bool restarts_on_reconnect);

  /// The next count, below the counter's modulus.
  SequenceStep advance(std::uint64_t count, TimeNs host_time_ns);

  /// The device was unplugged and is back.
  void reconnect() { is_new_ = is_new_ || restarts_on_reconnect_; }

 private:
  std::uint64_t modulus_;  // 0: 2^64
  double rate_Hz_;
  bool restarts_on_reconnect_;
  bool has_last_ = false, is_new_ = false;
  std::uint64_t last_ = 0, sequence_ = 0;
  TimeNs last_host_ns_ = 0;
};

/// What a clock shows about a report.
enum class ClockOutcome : std::uint8_t {
  first,
  next,
  restarted,     ///< restarted after a reconnection: time continues by the host's clock
  jumped_back,   ///< went back: time continues by the host's clock
  jumped_ahead,  ///< by more than a year, or beyond what TimeNs holds; likewise
};

/// A report's time.
struct ClockStep {
  ClockOutcome outcome = ClockOutcome::first;
  TimeNs time_ns = 0;
};

/// Turns the ticks of a wrapping clock into nanoseconds that never go back and start at the host
/// time of the first report. The number of reports shows how often the clock wrapped in between, if
/// it explains the ticks; else the host's time shows it, which must then be right to half the time
/// in which the clock wraps.
class DeviceClock {
 public:
  /// `rate_Hz` and `restarts_on_reconnect` as in SequenceCounter.
  DeviceClock(const CountingField& field, double rate_Hz, bool restarts_on_reconnect);

  /// The next reading, below the clock's modulus. `reports`: sent since the previous one, this one
  /// included; 0: not known.
  ClockStep advance(std::uint64_t ticks, TimeNs host_time_ns, std::uint64_t reports);

  /// The device was unplugged and is back.
  void reconnect() { is_new_ = is_new_ || restarts_on_reconnect_; }

 private:
  double wraps_for(double step_ns, double host_ns, std::uint64_t reports) const;
  bool move_by(std::uint64_t ticks);
  ClockStep go_on_by_host(ClockOutcome outcome, std::uint64_t host_ns);

  std::uint64_t modulus_;                 // ticks; 0: 2^64
  double tick_ns_, wrap_ns_, period_ns_;  // period_ns_ 0: not known
  bool restarts_on_reconnect_;
  bool has_last_ = false, is_new_ = false;
  std::uint64_t last_ = 0;
  TimeNs last_host_ns_ = 0, time_ns_ = 0;
  // time_ns_ is counted in ticks from here, so that rounding errors do not add up.
  TimeNs anchor_ns_ = 0;
  std::uint64_t ticks_since_anchor_ = 0;
};

}  // namespace condyle::hal
