// SPDX-License-Identifier: Apache-2.0
// Shared by the two halves of SessionLogWriter: its callers' (session_log.cpp) and its threads'
// (session_log_thread.cpp).
#pragma once

#include "condyle/hal/log/session_log.h"
#include "log/report_ring.h"
#include "log/worker.h"

namespace condyle::hal {

/// Places of a ring reserved for events.
inline constexpr std::size_t kEventPlaces = 64;

struct SessionLogWriter::Source {
  explicit Source(std::size_t report_places) : ring(report_places, kEventPlaces) {}
  ReportRing ring;
  // The writing thread's own.
  std::uint64_t announced_lost = 0;
  TimeNs last_time_ns = 0;
};

/// The failure for errno `error`.
SessionLogFailure failure_of(int error);

}  // namespace condyle::hal
