// SPDX-License-Identifier: Apache-2.0
#include "output/live_estimates.h"

#include <csignal>

#include <chrono>

#include "hosted/files/input_error.h"

namespace condyle::host {

LiveEstimates::LiveEstimates(const std::string& path, int axis_count, bool has_impedance)
    : file_(path, axis_count, has_impedance) {
  thread_ = std::thread([this] { run(); });
}

LiveEstimates::~LiveEstimates() {
  interrupt_writer();
}

void LiveEstimates::add(const EstimateRow& row) {
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

void LiveEstimates::run() {
  std::unique_lock lock(mutex_);
  try {
    for (;;) {
      changed_.wait(lock, [this] { return ends_ || !rows_.empty(); });
      if (rows_.empty()) break;
      const EstimateRow row = rows_.front();
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

void LiveEstimates::finish() {
  constexpr std::chrono::seconds kPatience(2);
  {
    std::unique_lock lock(mutex_);
    ends_ = true;
    changed_.notify_all();
    std::uint64_t written = written_;
    while (!changed_.wait_for(lock, kPatience, [this] { return has_ended_; })) {
      if (written == written_) break;
      written = written_;
    }
  }
  interrupt_writer();
  is_finished_ = true;
}

// A stalled reader blocks the thread in a write, which only a signal ends; the command's handler of
// SIGTERM has no other effect at this point.
void LiveEstimates::interrupt_writer() {
  if (!thread_.joinable()) return;
  std::unique_lock lock(mutex_);
  ends_ = true;
  if (!is_finished_ && !has_ended_) {
    dropped_ += rows_.size();
    rows_.clear();
  }
  changed_.notify_all();
  while (!changed_.wait_for(lock, std::chrono::milliseconds(200), [this] { return has_ended_; })) {
    pthread_kill(thread_.native_handle(), SIGTERM);
  }
  lock.unlock();
  thread_.join();
}

std::string LiveEstimates::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

}  // namespace condyle::host
