// SPDX-License-Identifier: Apache-2.0
// A microcontroller's twin on this computer: the same node receives the same frames over a pair of
// sockets.
#pragma once

#include <cstdint>
#include <thread>

#include "condyle/firmware/estimator_node.h"
#include "condyle/hal/link/serial_port.h"

namespace condyle::host {

/// Serves on a thread of its own until it is destroyed.
class InProcessNode {
 public:
  /// `scalar_size`: size of the numbers that it computes with, 4 or 8 (bytes). Throws InputError if
  /// the system has no pair of sockets left.
  InProcessNode(unsigned scalar_size, hal::Clock& clock);
  ~InProcessNode();
  InProcessNode(const InProcessNode&) = delete;
  InProcessNode& operator=(const InProcessNode&) = delete;

  /// The line to it.
  hal::ByteStream& line() { return near_; }

 private:
  class Target final : public firmware::NodeTarget {
   public:
    hal::GreetingMessage greeting() override;
    std::optional<hal::FaultMessage> fault() override { return std::nullopt; }
    void add_to(hal::HealthMessage&) override {}
    void feed_watchdog() override {}
  };

  hal::SerialPort near_, far_;
  Target target_;
  std::thread thread_;
};

}  // namespace condyle::host
