// SPDX-License-Identifier: Apache-2.0
// The way from the fake facebow to its host. One thread uses it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "condyle/estimator/sample.h"
#include "condyle/hal/clock.h"
#include "fake/account.h"
#include "fake/facebow_usb.h"

namespace condyle::host::fake {

/// How a transfer can fail.
enum class TransferFailure : std::uint8_t { none, stall, error };

/// What goes over the bus in one interrupt transfer.
struct Packet {
  std::array<std::uint8_t, kLargestPacket> bytes{};
  std::size_t size = 0;
  bool intact = true;  ///< a report as the device made it
  TransferFailure failure = TransferFailure::none;
};

/// One way to the host. Whatever makes it unusable is an InputError that says what to do.
class Transport {
 public:
  virtual ~Transport() = default;

  virtual std::string name() const = 0;
  /// The device appears at the host.
  virtual void plug() = 0;
  /// It disappears, where it is there; what was on its way is lost.
  virtual void unplug() = 0;
  /// Hands over a report; the transport says what became of it in `deliveries`.
  virtual void send(const Packet& packet) = 0;
  /// True if transfers can be made to fail: then `send` takes packets with a failure, whose
  /// report the transport does not count.
  virtual bool can_fail() const = 0;
  /// True if `is_taken` is more than a guess.
  virtual bool knows_taken() const = 0;
  /// Answers the host until `deadline_ns` of hal::SteadyClock, or earlier where something happened.
  virtual void serve(TimeNs deadline_ns) = 0;
  /// True if a host is ready to take a report.
  virtual bool is_read() = 0;
  /// True if the host has taken all that was sent, or this transport cannot know.
  virtual bool is_taken() = 0;
  /// What became of the reports so far; complete once unplugged.
  virtual Deliveries deliveries() = 0;
};

}  // namespace condyle::host::fake
