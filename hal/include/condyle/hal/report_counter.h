// SPDX-License-Identifier: Apache-2.0
// A device's counter and clock start again when they are full. Here they become a count and a time
// that do not, and what was lost on the way is counted.
#pragma once

#include <cstdint>
#include <optional>

#include "condyle/hal/device_profile.h"
#include "condyle/hal/report_decoder.h"

namespace condyle::hal {

/// What became of the reports. A damaged or short report is also one that the counter misses, so it
/// stands in `lost` too; received + lost = sent, as far as the last report received, unless
/// sequence_restarts or unknown_losses say otherwise.
struct ReportCounts {
  std::uint64_t received = 0;           ///< decoded, and not seen before
  std::uint64_t lost = 0;               ///< missed, by the device's own counter
  std::uint64_t duplicated = 0;         ///< the same count once more; not used
  std::uint64_t sequence_restarts = 0;  ///< the counter went back; what was lost is not known
  std::uint64_t unknown_losses = 0;     ///< gaps over which the counter cannot tell what was lost
  std::uint64_t clock_jumps = 0;        ///< the device's clock could not be followed
  std::uint64_t other_reports = 0;      ///< of another report id; no fault
  std::uint64_t too_short = 0;
  std::uint64_t wrong_checksum = 0;
  std::uint64_t counter_out_of_range = 0;
  std::uint64_t unusable_profile = 0;
};

/// What a counter says of a report.
enum class SequenceOutcome : std::uint8_t {
  first,
  next,
  lost,
  duplicated,
  restarted,
  unknown_loss
};

/// A report's place among those of its device.
struct SequenceStep {
  SequenceOutcome outcome = SequenceOutcome::first;
  std::uint64_t sequence = 0;  ///< 0 for the first; lost ones are counted
  std::uint64_t lost = 0;      ///< missed since the one before
};

/// Unwraps a counter. It tells losses of less than half of its values; a count further ahead is one
/// that went back. Longer losses are told from the host's time, as unknown, if the rate is known.
class SequenceCounter {
 public:
  /// `rate_Hz`: of the reports; 0: not known. `restarts_on_reconnect`: see DeviceProfile.
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

/// What a clock says of a report.
enum class ClockOutcome : std::uint8_t {
  first,
  next,
  restarted,     ///< anew after a reconnection: time goes on by the host's clock
  jumped_back,   ///< went back: time goes on by the host's clock
  jumped_ahead,  ///< by more than a year, or beyond what TimeNs holds; likewise
};

/// A report's time.
struct ClockStep {
  ClockOutcome outcome = ClockOutcome::first;
  TimeNs time_ns = 0;
};

/// Turns the ticks of a wrapping clock into nanoseconds that never go back and that start at the
/// host time of the first report. How often the clock wrapped in between is told by the number of
/// reports, if that explains the ticks, else by the host's time: that must be right to half the
/// time after which the clock wraps.
class DeviceClock {
 public:
  /// `rate_Hz` and `restarts_on_reconnect` as in SequenceCounter.
  DeviceClock(const CountingField& field, double rate_Hz, bool restarts_on_reconnect);

  /// The next reading, below the clock's modulus. `reports`: sent since the one before, this one
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
  // time_ns_ is counted in ticks from here, so that rounding does not add up.
  TimeNs anchor_ns_ = 0;
  std::uint64_t ticks_since_anchor_ = 0;
};

/// A report's place and time.
struct TrackedReport {
  SequenceStep sequence;  ///< of a profile without counter: the reports received
  ClockStep clock;        ///< of a profile without clock: the host's time
};

/// Follows counter and clock of one device, and counts.
class ReportTracker {
 public:
  explicit ReportTracker(const DeviceProfile& profile);

  /// A report that was decoded. A duplicated one keeps the time of the one before and is not to be
  /// used.
  TrackedReport accept(const DecodedReport& report, TimeNs host_time_ns);
  /// A report that was not.
  void refuse(ReportFault fault);
  /// The device was unplugged and is back.
  void reconnect();

  const ReportCounts& counts() const { return counts_; }

 private:
  std::optional<SequenceCounter> counter_;
  std::optional<DeviceClock> clock_;
  bool is_reconnected_ = false;
  TrackedReport last_;
  ReportCounts counts_;
};

}  // namespace condyle::hal
