// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pthread.h>
#include <signal.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace condyle::hal {

/// A thread that does one job after another, so that its stack and its part of the heap are taken
/// once. Signals are for the program's own threads, and this one blocks them all: also the one for
/// a file that is too large (SIGXFSZ), so that write() reports the error.
class Worker {
 public:
  /// Throws a std::system_error if the machine has no thread for it.
  Worker() {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    std::error_code error;
    try {
      thread_ = std::thread([this] { loop(); });
    } catch (const std::system_error& refused) {
      error = refused.code();
    }
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (error) throw std::system_error(error);
  }
  /// Waits for the job.
  ~Worker() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Begins `job`, which throws nothing. The one before must be done.
  void begin(std::function<void()> job) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      job_ = std::move(job);
    }
    changed_.notify_all();
  }
  /// Waits until the job is done; returns at once if there is none.
  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return !job_; });
  }

 private:
  void loop() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return job_ || ends_; });
      if (!job_) return;
      lock.unlock();
      job_();  // not replaced while it runs
      lock.lock();
      job_ = nullptr;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> job_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace condyle::hal
