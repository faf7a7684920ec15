// SPDX-License-Identifier: Apache-2.0
// The threads of a session log, and the file: one thread writes, one synchronises, so that a slow
// disk delays only the protection against power loss.
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <limits>
#include <utility>

#include "condyle/hal/clock.h"
#include "log/session_format.h"
#include "log/session_log_state.h"

namespace condyle::hal {
namespace {

// A report waits for a wake-up and then for its chunk's end: together below 250 ms.
constexpr std::chrono::nanoseconds kLongestWait{20'000'000}, kShortestWait{100'000};

std::chrono::nanoseconds wait_for_chunks_of(TimeNs chunk_time_ns) {
  if (chunk_time_ns <= 0) return kLongestWait;
  return std::clamp(std::chrono::nanoseconds(chunk_time_ns / 10), kShortestWait, kLongestWait);
}

}  // namespace

SessionLogFailure failure_of(int error) {
  switch (error) {
    case EEXIST:
      return SessionLogFailure::already_exists;
    case ENOENT:
    case ENOTDIR:
      return SessionLogFailure::not_found;
    case EACCES:
    case EPERM:
    case EROFS:
      return SessionLogFailure::not_permitted;
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return SessionLogFailure::disk_full;
    default:
      return SessionLogFailure::io_error;
  }
}

void SessionLogWriter::run() {
  SteadyClock clock;
  const std::chrono::nanoseconds wait = wait_for_chunks_of(options_.chunk_time_ns);
  bool stops = false;
  while (!stops) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      stops = wake_.wait_for(lock, wait, [this] { return stops_; });
    }
    drain();
    const bool has_entries = chunk_reports_ + chunk_events_ > 0;
    if (has_entries && clock.now_ns() - chunk_begin_ns_ >= options_.chunk_time_ns) flush();
  }
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    announce_lost(i, sources_[i]->ring.lost_count(), sources_[i]->last_time_ns);
  }
  flush();
  if (failure_ != SessionLogFailure::none) return;
  add_learned();
  if (!mcap_->finish([this] { return write_pending(); })) {
    return fail(SessionLogFailure::io_error, ENOMEM);
  }
  static_cast<void>(write_pending());
}

void SessionLogWriter::drain() {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    ReportRing& ring = sources_[i]->ring;
    // Takes only what is there now: a fast source must not keep the thread from its other work.
    for (std::uint64_t left = ring.size(); left > 0; --left) {
      add(i, *ring.front());
      ring.pop();
      if (mcap_->chunk_size() >= kFullChunkBytes) flush();
    }
  }
}

void SessionLogWriter::add(std::size_t source_index, const RingSlot& slot) {
  if (failure_ != SessionLogFailure::none) {
    ++(slot.event == 0 ? reports_unwritten_ : events_unwritten_);
    return;
  }
  if (chunk_reports_ + chunk_events_ == 0) chunk_begin_ns_ = SteadyClock().now_ns();
  const RawReport& report = slot.report;
  announce_lost(source_index, slot.lost_count, report.host_time_ns);
  sources_[source_index]->last_time_ns = report.host_time_ns;
  if (slot.event == 0) {
    encode_report(report, message_);
    mcap_->add_message(report_channel(source_index), log_time_ns(report.host_time_ns), message_);
    ++chunk_reports_;
  } else {
    add_event(source_index, report.host_time_ns, static_cast<SessionEvent>(slot.event), slot.count,
              text_of(report.data()));
    ++chunk_events_;
  }
}

void SessionLogWriter::add_event(std::size_t source_index, TimeNs time_ns, SessionEvent kind,
                                 std::uint64_t count, std::string_view text) {
  encode_event(time_ns, kind, count, text, message_);
  mcap_->add_message(event_channel(source_index), log_time_ns(time_ns), message_);
}

void SessionLogWriter::announce_lost(std::size_t source_index, std::uint64_t lost_count,
                                     TimeNs time_ns) {
  Source& source = *sources_[source_index];
  if (lost_count == source.announced_lost || failure_ != SessionLogFailure::none) return;
  add_event(source_index, time_ns, SessionEvent::not_recorded, lost_count - source.announced_lost,
            "the recorder's ring was full");
  source.announced_lost = lost_count;
}

// MCAP needs one clock for all; the wall clock shows the date. The reports keep their own times.
std::uint64_t SessionLogWriter::log_time_ns(TimeNs time_ns) const {
  TimeNs since_start_ns = 0, wall_ns = 0;
  if (__builtin_sub_overflow(time_ns, start_monotonic_ns_, &since_start_ns) ||
      __builtin_add_overflow(start_wall_ns_, since_start_ns, &wall_ns)) {
    wall_ns = time_ns < start_monotonic_ns_ ? 0 : std::numeric_limits<TimeNs>::max();
  }
  return static_cast<std::uint64_t>(std::max<TimeNs>(wall_ns, 0));
}

void SessionLogWriter::flush() {
  if (failure_ == SessionLogFailure::none && mcap_->chunk_size() > 0) {
    if (!mcap_->finish_chunk()) fail(SessionLogFailure::io_error, ENOMEM);
    if (failure_ == SessionLogFailure::none && write_pending()) {
      ++chunks_written_;
      reports_written_ += std::exchange(chunk_reports_, 0);
      events_written_ += std::exchange(chunk_events_, 0);
    }
  }
  // Empty if the chunk was written.
  reports_unwritten_ += std::exchange(chunk_reports_, 0);
  events_unwritten_ += std::exchange(chunk_events_, 0);
}

void SessionLogWriter::add_learned() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (learned_.empty()) return;
  mcap_->add_attachment({.log_time_ns = static_cast<std::uint64_t>(start_wall_ns_),
                         .name = kLearnedName,
                         .media_type = "application/json",
                         .data = bytes_of(learned_)});
}

bool SessionLogWriter::write_pending() {
  ByteSpan rest = mcap_->pending();
  int error = 0;
  while (!rest.empty() && error == 0) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written > 0) {
      rest = rest.subspan(static_cast<std::size_t>(written));
    } else if (written < 0 && errno != EINTR) {
      error = errno;
    }
  }
  if (error != 0) {
    fail(failure_of(error), error);
    // Cuts the file back to the last whole piece; if that fails, readers treat the rest as cut off.
    static_cast<void>(::ftruncate(descriptor_, static_cast<off_t>(bytes_written_.load())));
    return false;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    bytes_written_ += mcap_->pending().size();
  }
  written_.notify_one();
  mcap_->discard_pending();
  return true;
}

void SessionLogWriter::synchronise() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    written_.wait(lock, [this] { return bytes_written_ > bytes_synchronised_ || is_complete_; });
    const std::uint64_t bytes = bytes_written_;
    if (bytes == bytes_synchronised_) return;
    lock.unlock();
    if (!synchronise_file()) return;
    lock.lock();
    bytes_synchronised_ = bytes;
  }
}

bool SessionLogWriter::synchronise_file() {
  if (fdatasync(descriptor_) == 0) return true;
  const int error = errno;
  fail(failure_of(error), error);
  return false;
}

void SessionLogWriter::fail(SessionLogFailure failure, int system_error) {
  if (has_failed_.exchange(true)) return;  // the first failure counts
  system_error_ = system_error;
  failure_.store(failure);
}

}  // namespace condyle::hal
