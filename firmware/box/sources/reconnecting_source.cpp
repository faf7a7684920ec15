// SPDX-License-Identifier: Apache-2.0
#include "box/sources/reconnecting_source.h"

#include <algorithm>

namespace condyle::box {

hal::Status ReconnectingSource::open() {
  if (is_open()) return hal::Status::ok;
  const TimeNs now_ns = clock_.now_ns();
  if (now_ns < next_attempt_ns_) return hal::Status::not_found;
  const hal::Status status = source_.open();
  last_status_.store(status, std::memory_order_relaxed);
  if (status != hal::Status::ok) {
    next_attempt_ns_ = clock_.now_ns() + pause_ns_;
    pause_ns_ = std::min(2 * pause_ns_, kLongestPause_ns);
    return status;
  }
  pause_ns_ = kFirstPause_ns;
  connections_.store(connections() + 1, std::memory_order_relaxed);
  is_open_.store(true, std::memory_order_relaxed);
  return status;
}

hal::Status ReconnectingSource::read(TimeNs deadline_ns, hal::RawReport& report) {
  const hal::Status status = source_.read(deadline_ns, report);
  last_status_.store(status, std::memory_order_relaxed);
  if (status == hal::Status::disconnected) {
    is_open_.store(false, std::memory_order_relaxed);
    next_attempt_ns_ = clock_.now_ns() + pause_ns_;
  }
  return status;
}

void ReconnectingSource::close() {
  source_.close();
  is_open_.store(false, std::memory_order_relaxed);
}

}  // namespace condyle::box
