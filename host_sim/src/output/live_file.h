// SPDX-License-Identifier: Apache-2.0
// Writes rows live, without blocking the estimator.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "hosted/files/input_error.h"
#include "hosted/system/system.h"

namespace condyle::host {

/// A thread writes. Rows are dropped and counted if a slow reader leaves no room. An error of the
/// file ends the writing, not the recording. `File` is as EstimatesFile.
template <class File>
class LiveFile {
 public:
  using Row = typename File::Row;

  /// The arguments make the file. Throws InputError if it cannot be made.
  template <class... Arguments>
  explicit LiveFile(Arguments&&... arguments)
      : file_(std::forward<Arguments>(arguments)...), thread_([this] { run(); }) {}
  ~LiveFile();
  LiveFile(const LiveFile&) = delete;
  LiveFile& operator=(const LiveFile&) = delete;

  /// Never waits for the file.
  void add(const Row& row);
  /// Writes the remaining rows and renames the file; abandons a reader that stalls for two seconds.
  /// A regular file has none: a slow disk is waited for.
  void finish();

  /// After finish: number of dropped rows.
  std::uint64_t dropped() const { return dropped_; }
  /// Why the file is not complete; empty if it is.
  std::string problem() const;

 private:
  static constexpr std::size_t kRoom = 8192;  // rows: 16 s at 500 Hz

  void run();
  void interrupt_writer();

  File file_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Row> rows_;
  bool ends_ = false, has_ended_ = false, is_finished_ = false;
  std::uint64_t dropped_ = 0, written_ = 0;
  std::string problem_;
  std::thread thread_;
};

template <class File>
LiveFile<File>::~LiveFile() {
  interrupt_writer();
}

template <class File>
void LiveFile<File>::add(const Row& row) {
  {
    const std::lock_guard lock(mutex_);
    if (has_ended_ || rows_.size() >= kRoom) {
      ++dropped_;
      return;
    }
    rows_.push_back(row);
  }
  changed_.notify_one();
}

template <class File>
void LiveFile<File>::run() {
  std::unique_lock lock(mutex_);
  try {
    for (;;) {
      changed_.wait(lock, [this] { return ends_ || !rows_.empty(); });
      if (rows_.empty()) break;
      const Row row = rows_.front();
      rows_.pop_front();
      lock.unlock();
      file_.write_row(row);
      lock.lock();
      ++written_;
    }
    lock.unlock();
    file_.close();
    file_.commit();
    lock.lock();
  } catch (const InputError& error) {
    if (!lock.owns_lock()) lock.lock();
    problem_ = error.what();
    dropped_ += rows_.size();
    rows_.clear();
  }
  has_ended_ = true;
  changed_.notify_all();
}

template <class File>
void LiveFile<File>::finish() {
  // In short waits, so that a stall of this computer counts as one.
  constexpr std::chrono::milliseconds kWait(100);
  constexpr int kWaits = 20;
  {
    std::unique_lock lock(mutex_);
    ends_ = true;
    changed_.notify_all();
    std::uint64_t written = written_;
    int quiet = 0;
    while (!changed_.wait_for(lock, kWait, [this] { return has_ended_; })) {
      quiet = written == written_ ? quiet + 1 : 0;
      written = written_;
      if (file_.has_reader() && quiet >= kWaits) break;
    }
  }
  interrupt_writer();
  is_finished_ = true;
}

// A stalled reader blocks the thread in a write.
template <class File>
void LiveFile<File>::interrupt_writer() {
  if (!thread_.joinable()) return;
  std::unique_lock lock(mutex_);
  ends_ = true;
  if (!is_finished_ && !has_ended_) {
    dropped_ += rows_.size();
    rows_.clear();
  }
  changed_.notify_all();
  while (!changed_.wait_for(lock, std::chrono::milliseconds(200), [this] { return has_ended_; })) {
    interrupt_write(thread_);
  }
  lock.unlock();
  thread_.join();
}

template <class File>
std::string LiveFile<File>::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

}  // namespace condyle::host
