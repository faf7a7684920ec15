// SPDX-License-Identifier: Apache-2.0
#include "output/live_estimates.h"

#include <chrono>

#include "hosted/files/input_error.h"
#include "hosted/system/system.h"

namespace condyle::host {

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
  constexpr std::chrono::seconds kPatience(2);
  {
    std::unique_lock lock(mutex_);
    ends_ = true;
    changed_.notify_all();
    std::uint64_t written = written_;
    while (!changed_.wait_for(lock, kPatience, [this] { return has_ended_; })) {
      if (file_.has_reader() && written == written_) break;
      written = written_;
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

template class LiveFile<EstimatesFile>;
template class LiveFile<PoseFile>;
template class LiveFile<CyclesFile>;

}  // namespace condyle::host
