// SPDX-License-Identifier: Apache-2.0
// Counts the reports of a device.
#pragma once

#include <cstdint>
#include <optional>

#include "condyle/hal/report/report_counter.h"
#include "condyle/hal/report/report_decoder.h"

namespace condyle::hal {

/// Counts of reports. The counter also misses a damaged or short report, so `lost` includes it.
/// received + lost = sent, up to the last report received, unless there were sequence_restarts or
/// unknown_losses.
struct ReportCounts {
  std::uint64_t received = 0;               ///< decoded, and not seen before
  std::uint64_t lost = 0;                   ///< missed, by the device's counter
  std::uint64_t duplicated = 0;             ///< the same count again; not used
  std::uint64_t sequence_restarts = 0;      ///< the counter went back; losses unknown
  std::uint64_t unknown_losses = 0;         ///< gaps whose length the counter cannot give
  std::uint64_t unknown_reconnections = 0;  ///< of those, after reconnections with a restart
  std::uint64_t clock_jumps = 0;            ///< the device's clock could not be followed
  std::uint64_t other_reports = 0;          ///< with another report id; not a fault
  std::uint64_t too_short = 0;
  std::uint64_t wrong_checksum = 0;
  std::uint64_t counter_out_of_range = 0;
  std::uint64_t unusable_profile = 0;
};

/// A report's place and time.
struct TrackedReport {
  SequenceStep sequence;  ///< without a counter in the layout: the reports received
  ClockStep clock;        ///< without a clock in the layout: the host's time
};

/// Follows counter and clock of one device, and counts.
class ReportTracker {
 public:
  explicit ReportTracker(const ReportContent& content);

  /// Takes a decoded report. A duplicate keeps the time of the previous report; do not use it.
  TrackedReport accept(const DecodedReport& report, TimeNs host_time_ns);
  /// Takes a report that could not be decoded.
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
