// SPDX-License-Identifier: Apache-2.0
// What the two halves of SessionLogWriter share: its callers' (session_log.cpp) and its thread's
// (session_log_thread.cpp).
#pragma once

#include "condyle/hal/log/session_log.h"
#include "log/report_ring.h"

namespace condyle::hal {

/// Places of a ring that only events may take.
inline constexpr std::size_t kEventPlaces = 64;

struct SessionLogWriter::Source {
  explicit Source(std::size_t report_places) : ring(report_places, kEventPlaces) {}
  ReportRing ring;
  // The writing thread's own.
  std::uint64_t announced_lost = 0;
  TimeNs last_time_ns = 0;
};

/// The failure that errno `error` stands for.
SessionLogFailure failure_of(int error);

}  // namespace condyle::hal
