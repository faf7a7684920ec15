// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "condyle/hal/report/raw_report.h"
#include "log/little_endian.h"

namespace condyle::hal {

/// The content of one place in the ring: a report, or an event with its text.
struct RingSlot {
  RawReport report;              ///< for an event: its time and text
  std::uint8_t event = 0;        ///< SessionEvent; 0: a report
  std::uint64_t count = 1;       ///< how often it happened
  std::uint64_t lost_count = 0;  ///< reports and events lost before this one, since the start
};

/// A queue of fixed size between one writing and one reading thread; neither waits.
class ReportRing {
 public:
  /// `report_places` for reports or events, and `event_places` more for events only.
  ReportRing(std::size_t report_places, std::size_t event_places)
      : slots_(report_places + event_places), report_places_(report_places) {}

  /// For the writing thread: a place to fill, then call publish(); nullptr, and counted, if the
  /// ring is full.
  RingSlot* reserve(bool is_event) {
    const std::uint64_t used = put_.load(std::memory_order_relaxed) -  //
                               taken_.load(std::memory_order_acquire);
    if (used >= (is_event ? slots_.size() : report_places_)) {
      std::atomic<std::uint64_t>& lost = is_event ? lost_events_ : lost_reports_;
      lost.store(lost.load(std::memory_order_relaxed) + 1, std::memory_order_release);
      return nullptr;
    }
    RingSlot& slot = slots_[to_size(put_.load(std::memory_order_relaxed) % slots_.size())];
    slot.lost_count = lost_count();
    return &slot;
  }
  void publish() {
    put_.store(put_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// For the reading thread: the oldest entry, then call pop(); nullptr if there is none.
  const RingSlot* front() const {
    const std::uint64_t taken = taken_.load(std::memory_order_relaxed);
    if (taken == put_.load(std::memory_order_acquire)) return nullptr;
    return &slots_[to_size(taken % slots_.size())];
  }
  /// For the reading thread: number of entries.
  std::uint64_t size() const {
    return put_.load(std::memory_order_acquire) - taken_.load(std::memory_order_relaxed);
  }
  void pop() {
    taken_.store(taken_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Empties it and its counts, while no other thread uses it.
  void clear() {
    put_ = taken_ = 0;
    lost_reports_ = lost_events_ = 0;
  }

  std::uint64_t lost_reports() const { return lost_reports_.load(std::memory_order_acquire); }
  std::uint64_t lost_events() const { return lost_events_.load(std::memory_order_acquire); }
  std::uint64_t lost_count() const { return lost_reports() + lost_events(); }

 private:
  std::vector<RingSlot> slots_;
  std::size_t report_places_;
  // Entries put and taken so far; 64 bits never wrap.
  std::atomic<std::uint64_t> put_ = 0, taken_ = 0;
  std::atomic<std::uint64_t> lost_reports_ = 0, lost_events_ = 0;
};

}  // namespace condyle::hal
