// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "condyle/hal/clock.h"
#include "condyle/hal/report/raw_report.h"

namespace condyle::box {

/// A source of the facebow's reports for one thread, whose state any thread may read. It stays open
/// from one run to the next. If a device is away, it is looked for after 20 ms, then after twice as
/// long each time, up to 2 s.
class ReconnectingSource final : public hal::ReportSource {
 public:
  /// `source` reads on `clock`.
  ReconnectingSource(hal::ReportSource& source, hal::Clock& clock)
      : source_(source), clock_(clock) {}

  /// Returns ok at once if it is open; not_found without looking if it is too early.
  hal::Status open() override;
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override;
  void close() override;
  hal::TransportCounts counts() const override { return source_.counts(); }

  bool is_open() const { return is_open_.load(std::memory_order_relaxed); }
  /// Result of the last attempt to open or read it.
  hal::Status last_status() const { return last_status_.load(std::memory_order_relaxed); }
  std::uint64_t connections() const { return connections_.load(std::memory_order_relaxed); }

 private:
  static constexpr TimeNs kFirstPause_ns = 20'000'000, kLongestPause_ns = 2'000'000'000;

  hal::ReportSource& source_;
  hal::Clock& clock_;
  TimeNs pause_ns_ = kFirstPause_ns, next_attempt_ns_ = 0;
  std::atomic<bool> is_open_ = false;
  std::atomic<hal::Status> last_status_ = hal::Status::not_open;
  std::atomic<std::uint64_t> connections_ = 0;
};

}  // namespace condyle::box
