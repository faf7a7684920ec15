// SPDX-License-Identifier: Apache-2.0
// The connection of the fake facebow to its host. One thread uses it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "condyle/estimator/sample.h"
#include "condyle/hal/clock.h"
#include "fake/delivery_log.h"
#include "fake/facebow_usb.h"

namespace condyle::host::fake {

/// How a transfer can fail.
enum class TransferFailure : std::uint8_t { none, stall, error };

/// The content of one interrupt transfer.
struct Packet {
  std::array<std::uint8_t, kLargestPacket> bytes{};
  std::size_t size = 0;
  bool intact = true;  ///< an unaltered report
  TransferFailure failure = TransferFailure::none;
};

/// A connection to the host. If it is unusable, it throws an InputError with the remedy.
class Transport {
 public:
  virtual ~Transport() = default;

  virtual std::string name() const = 0;
  /// The device appears at the host.
  virtual void plug() = 0;
  /// The device disappears, if it was there; reports in transit are lost.
  virtual void unplug() = 0;
  /// Sends a report; `deliveries` counts the result.
  virtual void send(const Packet& packet) = 0;
  /// True if transfers can fail on request: then `send` accepts packets with a failure, and does
  /// not count their reports.
  virtual bool can_fail() const = 0;
  /// True if `is_taken` is reliable.
  virtual bool knows_taken() const = 0;
  /// Answers the host until `deadline_ns` of hal::SteadyClock, or earlier if something happened.
  virtual void serve(TimeNs deadline_ns) = 0;
  /// True if a host is ready to read a report.
  virtual bool is_read() = 0;
  /// True if the host has read all reports, or if this transport cannot know.
  virtual bool is_taken() = 0;
  /// Fates of the reports so far; complete after the unplugging.
  virtual Deliveries deliveries() = 0;
};

}  // namespace condyle::host::fake
