// SPDX-License-Identifier: Apache-2.0
// The fake facebow's exact account of each report.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "fake/fault_script.h"

namespace condyle::host::fake {

/// Fates of reports.
struct Deliveries {
  std::uint64_t intact = 0;          ///< delivered as made
  std::uint64_t altered = 0;         ///< delivered with a fault
  std::uint64_t lost_in_queue = 0;   ///< the reader was slow and the queue full
  std::uint64_t lost_unread = 0;     ///< no program had the device open
  std::uint64_t lost_unplugged = 0;  ///< in transit when the device was unplugged
  std::uint64_t lost_failed = 0;     ///< in a failed transfer

  std::uint64_t total() const {
    return intact + altered + lost_in_queue + lost_unread + lost_unplugged + lost_failed;
  }
};

/// Of a run.
struct DeliveryLog {
  std::string transport;
  std::string ended;  ///< reason of the end
  std::uint64_t made = 0;
  Deliveries deliveries;
  std::uint32_t first_counter = 0, last_counter = 0;  ///< of the reports made
  std::int64_t counter_jumped = 0;                    ///< by faults, in all
  std::uint64_t plugged_in = 0;                       ///< number of times
  std::array<std::uint64_t, kFaultKinds> done{};
  /// Faults that were not possible: two in one report, or not supported by the transport.
  std::array<std::uint64_t, kFaultKinds> not_done{};

  /// Every report is accounted for once.
  bool balances() const { return made == deliveries.total(); }
};

/// The account as one line of JSON, without line end.
std::string delivery_log_json(const DeliveryLog& delivery_log);

}  // namespace condyle::host::fake
