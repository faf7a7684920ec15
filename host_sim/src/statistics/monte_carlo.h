// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace condyle::host {

/// Called on the caller's thread, after each merged run.
using MonteCarloProgress = std::function<void(std::uint64_t merged, std::uint64_t runs)>;

struct MonteCarloControl {
  unsigned threads = 0;  ///< 0: one for each core
  /// Called after each merged run, on the caller's thread; true ends the work. If it depends only
  /// on the merged results, the outcome is the same for every number of threads.
  std::function<bool()> stop;
  /// Called a few times per second on the caller's thread while it waits for a run.
  std::function<void()> while_waiting;
};

/// Results of runs in progress or waiting to be merged: a ring with one place for each.
template <class Result>
class MonteCarloQueue {
 public:
  MonteCarloQueue(std::uint64_t runs, std::size_t places) : runs_(runs), places_(places) {}

  /// Waits for the next run and returns its index; nothing when all are assigned or `stop` is
  /// requested.
  std::optional<std::uint64_t> take(std::stop_token stop) {
    std::unique_lock lock(mutex_);
    const bool free = place_freed_.wait(
        lock, stop, [this] { return next_ == runs_ || next_ < merged_ + places_.size(); });
    if (!free || stop.stop_requested() || next_ == runs_) return std::nullopt;
    return next_++;
  }

  void put(std::uint64_t index, std::optional<Result> result, std::exception_ptr failure) {
    {
      const std::lock_guard lock(mutex_);
      place_of(index) = {std::move(result), std::move(failure), true};
    }
    result_put_.notify_one();
  }

  /// Waits for the next result in order and frees its place; calls `while_waiting`, if set, a few
  /// times per second. Rethrows an exception of the run.
  Result next_in_order(const std::function<void()>& while_waiting) {
    constexpr std::chrono::milliseconds kPatience(200);
    Place place;
    {
      std::unique_lock lock(mutex_);
      Place& next = place_of(merged_);
      const auto is_filled = [&next] { return next.filled; };
      while (while_waiting && !result_put_.wait_for(lock, kPatience, is_filled)) {
        lock.unlock();
        while_waiting();
        lock.lock();
      }
      result_put_.wait(lock, is_filled);
      place = std::exchange(next, Place{});
      ++merged_;
    }
    place_freed_.notify_all();
    if (place.failure) std::rethrow_exception(std::move(place.failure));
    return std::move(*place.result);
  }

 private:
  struct Place {
    std::optional<Result> result;
    std::exception_ptr failure;
    bool filled = false;
  };
  Place& place_of(std::uint64_t index) {
    return places_[static_cast<std::size_t>(index % places_.size())];
  }

  std::mutex mutex_;
  std::condition_variable_any place_freed_;
  std::condition_variable result_put_;
  const std::uint64_t runs_;
  std::uint64_t next_ = 0, merged_ = 0;
  std::vector<Place> places_;
};

/// Runs `work(seed)` for `runs` seeds from `first_seed` upwards on all cores and hands the results
/// to `merge(Result&&)` in the order of the seeds, on the caller's thread: if `work` depends only
/// on its seed, the outcome is the same, bit for bit, for every number of threads. At most two
/// results for each thread are stored. An exception of `work` is rethrown in its turn, those of
/// `merge`, `progress` and the functions of `control` at once; runs in progress are then finished
/// and dropped. Returns the number of runs merged: `runs`, or fewer when stopped.
template <class Work, class Merge>
std::uint64_t run_monte_carlo(std::uint64_t runs, std::uint64_t first_seed, const Work& work,
                              Merge&& merge, const MonteCarloProgress& progress = {},
                              const MonteCarloControl& control = {}) {
  using Result = std::invoke_result_t<const Work&, std::uint64_t>;
  if (runs == 0) return 0;
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const std::uint64_t wanted = control.threads > 0 ? control.threads : cores;
  const auto threads = static_cast<std::size_t>(std::min(wanted, runs));

  MonteCarloQueue<Result> queue(runs, 2 * threads);
  const auto run_until_stopped = [&](std::stop_token stop) {
    while (const auto index = queue.take(stop)) {
      std::optional<Result> result;
      std::exception_ptr failure;
      try {
        result.emplace(work(first_seed + *index));
      } catch (...) {
        failure = std::current_exception();
      }
      queue.put(*index, std::move(result), std::move(failure));
    }
  };
  // Ask all to stop before joining the first.
  struct Workers {
    std::vector<std::jthread> threads;
    ~Workers() {
      for (auto& thread : threads) thread.request_stop();
    }
  } workers;
  workers.threads.reserve(threads);
  while (workers.threads.size() < threads) workers.threads.emplace_back(run_until_stopped);

  for (std::uint64_t merged = 1; merged <= runs; ++merged) {
    merge(queue.next_in_order(control.while_waiting));
    if (progress) progress(merged, runs);
    if (control.stop && control.stop()) return merged;
  }
  return runs;
}

}  // namespace condyle::host
