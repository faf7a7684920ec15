// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

#include "fake/transport.h"

namespace condyle::host::fake {

/// Reports that wait for the host, as many as the kernel's hidraw keeps (HIDRAW_BUFFER_SIZE); a
/// full queue drops the newest. Counts them.
class ReportQueue {
 public:
  static constexpr std::size_t kLongest = 64;

  /// Takes a packet, or counts its report as lost and returns false.
  bool push(const Packet& packet) {
    const bool has_room = waiting_.size() < kLongest;
    if (has_room) {
      waiting_.push_back(packet);
    } else if (packet.failure == TransferFailure::none) {
      ++deliveries_.lost_in_queue;
    }
    return has_room;
  }
  bool empty() const { return waiting_.empty(); }
  /// The oldest, not yet delivered.
  Packet pop() {
    const Packet packet = waiting_.front();
    waiting_.pop_front();
    return packet;
  }
  /// The host has taken `packet`.
  void count_delivered(const Packet& packet) {
    if (packet.failure != TransferFailure::none) return;
    ++(packet.intact ? deliveries_.intact : deliveries_.altered);
  }
  /// `packet` was in transit when the device was unplugged.
  void count_unplugged(const Packet& packet) {
    if (packet.failure == TransferFailure::none) ++deliveries_.lost_unplugged;
  }
  void count_unread() { ++deliveries_.lost_unread; }
  /// Counts all waiting reports as lost with the device.
  void unplug() {
    while (!waiting_.empty()) count_unplugged(pop());
  }
  const Deliveries& deliveries() const { return deliveries_; }

 private:
  std::deque<Packet> waiting_;
  Deliveries deliveries_;
};

}  // namespace condyle::host::fake
