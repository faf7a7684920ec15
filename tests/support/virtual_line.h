// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>

#include "condyle/hal/clock.h"
#include "condyle/hal/link/byte_stream.h"

namespace condyle::testing_support {

/// A line between two threads, with its own time. Time stands still while a thread works; when all
/// wait, it jumps to the earliest time that one waits for. So nothing depends on the speed of the
/// threads.
class VirtualLine {
 public:
  /// One end, and the clock of the thread that uses it. Only that thread may use them.
  class End final : public hal::ByteStream, public hal::Clock {
   public:
    explicit End(VirtualLine& line, std::size_t index) : line_(line), index_(index) {}
    hal::Status read(TimeNs deadline_ns, std::span<std::uint8_t> bytes,
                     std::size_t& count) override {
      return line_.read(index_, deadline_ns, bytes, count);
    }
    hal::Status write(std::span<const std::uint8_t> bytes) override {
      return line_.write(index_, bytes);
    }
    TimeNs now_ns() override { return line_.now_ns(); }
    void sleep_until(TimeNs time_ns) override { line_.sleep_until(index_, time_ns); }

   private:
    VirtualLine& line_;
    std::size_t index_;
  };

  VirtualLine() { ends_[0].is_attached = true; }

  /// The far end counts only between attach and detach.
  void attach_far() { set_attached(true); }
  void detach_far() { set_attached(false); }
  /// Ends the direction to the near end; bytes under way still arrive.
  void end_to_near() { end_to({0}); }
  /// Ends both directions.
  void cut() { end_to({0, 1}); }

  End near{*this, 0}, far{*this, 1};

 private:
  struct State {
    std::deque<std::uint8_t> bytes;  // on their way to it
    bool has_ended = false;          // no more will come
    bool is_attached = false;
    bool is_reading = false;
    std::optional<TimeNs> waits_until_ns;

    bool has_come() const { return !bytes.empty() || has_ended; }
  };

  TimeNs now_ns() {
    const std::lock_guard lock(mutex_);
    return now_ns_;
  }

  void set_attached(bool is_attached) {
    const std::lock_guard lock(mutex_);
    ends_[1].is_attached = is_attached;
    pass_time();
  }

  void end_to(std::initializer_list<std::size_t> indices) {
    const std::lock_guard lock(mutex_);
    for (const std::size_t index : indices) ends_[index].has_ended = true;
    changed_.notify_all();
  }

  hal::Status read(std::size_t index, TimeNs deadline_ns, std::span<std::uint8_t> bytes,
                   std::size_t& count) {
    std::unique_lock lock(mutex_);
    State& own = ends_[index];
    wait(lock, own, deadline_ns, true);
    count = std::min(bytes.size(), own.bytes.size());
    const auto end = own.bytes.begin() + static_cast<std::ptrdiff_t>(count);
    std::copy(own.bytes.begin(), end, bytes.begin());
    own.bytes.erase(own.bytes.begin(), end);
    if (count > 0) return hal::Status::ok;
    return own.has_ended ? hal::Status::disconnected : hal::Status::timeout;
  }

  hal::Status write(std::size_t index, std::span<const std::uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    State& other = ends_[1 - index];
    if (other.has_ended) return hal::Status::disconnected;
    other.bytes.insert(other.bytes.end(), bytes.begin(), bytes.end());
    changed_.notify_all();
    return hal::Status::ok;
  }

  void sleep_until(std::size_t index, TimeNs time_ns) {
    std::unique_lock lock(mutex_);
    wait(lock, ends_[index], time_ns, false);
  }

  void wait(std::unique_lock<std::mutex>& lock, State& own, TimeNs deadline_ns, bool is_reading) {
    own.waits_until_ns = deadline_ns;
    own.is_reading = is_reading;
    pass_time();
    changed_.wait(lock, [&] { return now_ns_ >= deadline_ns || (is_reading && own.has_come()); });
    own.waits_until_ns.reset();
  }

  // When all wait, jumps to the earliest time that one waits for.
  void pass_time() {
    TimeNs earliest_ns = hal::kNoDeadline;
    for (const State& end : ends_) {
      if (!end.is_attached) continue;
      const bool waits = end.waits_until_ns && *end.waits_until_ns > now_ns_ &&
                         !(end.is_reading && end.has_come());
      if (!waits) return;
      earliest_ns = std::min(earliest_ns, *end.waits_until_ns);
    }
    if (earliest_ns == hal::kNoDeadline) return;
    now_ns_ = earliest_ns;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  TimeNs now_ns_ = 0;
  std::array<State, 2> ends_;
};

}  // namespace condyle::testing_support
