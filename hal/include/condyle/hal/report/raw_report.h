// SPDX-License-Identifier: Apache-2.0
// Undecoded reports of a device, whatever their source. hidapi, libusb, a session log and a capture
// file are sources of reports; one decoder reads them all.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "condyle/estimator/sample.h"
#include "condyle/hal/status.h"

namespace condyle::hal {

/// Longest report accepted, report id included: a high-speed interrupt packet.
inline constexpr std::size_t kMaxReportSize = 1024;

/// One input report as it arrived. If the device numbers its reports, bytes[0] is the number.
struct RawReport {
  TimeNs host_time_ns = 0;  ///< arrival, on the host's monotonic clock
  std::uint16_t size = 0;   ///< of `bytes`
  std::array<std::uint8_t, kMaxReportSize> bytes{};

  /// The bytes that arrived.
  constexpr std::span<const std::uint8_t> data() const { return {bytes.data(), size}; }
};

/// Faults below the reports, counted since the source was made.
struct TransportCounts {
  std::uint64_t stalls = 0;           ///< endpoint halted, and cleared again
  std::uint64_t transfer_errors = 0;  ///< transfers that failed otherwise
  std::uint64_t oversized = 0;        ///< reports longer than kMaxReportSize, dropped
  std::uint64_t disconnections = 0;
};

/// A source of raw reports. One thread uses it at a time.
class ReportSource {
 public:
  /// Makes the source ready. ok, not_found, not_permitted or bad_report (such a source cannot be
  /// read). After disconnected it may be called again until the device is back.
  virtual Status open() = 0;

  /// Next report, waited for until `deadline_ns` of the clock the source was built with. ok,
  /// timeout, end, not_open or disconnected; `report` is written only with ok. A recording that is
  /// damaged gives bad_report once, then end.
  virtual Status read(TimeNs deadline_ns, RawReport& report) = 0;

  /// Releases the source; may be called at any time, also twice.
  virtual void close() = 0;

  /// Faults so far.
  virtual TransportCounts counts() const = 0;

 protected:
  ~ReportSource() = default;  // not virtual: sources are never deleted through this interface
};

}  // namespace condyle::hal
