// SPDX-License-Identifier: Apache-2.0
// What became of a device's reports.
#pragma once

#include <cstdint>
#include <optional>

#include "condyle/hal/report/report_counter.h"
#include "condyle/hal/report/report_decoder.h"

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
  std::uint64_t unknown_reconnections = 0;  ///< of those, where it was unplugged and starts anew
  std::uint64_t clock_jumps = 0;            ///< the device's clock could not be followed
  std::uint64_t other_reports = 0;          ///< of another report id; no fault
  std::uint64_t too_short = 0;
  std::uint64_t wrong_checksum = 0;
  std::uint64_t counter_out_of_range = 0;
  std::uint64_t unusable_profile = 0;
};

/// A report's place and time.
struct TrackedReport {
  SequenceStep sequence;  ///< of a layout without counter: the reports received
  ClockStep clock;        ///< of a layout without clock: the host's time
};

/// Follows counter and clock of one device, and counts.
class ReportTracker {
 public:
  explicit ReportTracker(const ReportContent& content);

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
