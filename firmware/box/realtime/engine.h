// SPDX-License-Identifier: Apache-2.0
// The real-time thread: turns the facebow's reports into estimates in a ring, or passes them to a
// microcontroller's feed.
//
// Between receiving a report and putting its estimate into the ring the thread takes no lock,
// allocates no memory and does no other input or output. Raw reports go into the session log's own
// ring on the way. Other threads read its counters without locking. The thread does other work only
// between runs and while the facebow is away.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "box/configuration.h"
#include "box/realtime/estimate_outlet.h"
#include "box/realtime/node_feed.h"
#include "box/sources/reconnecting_source.h"
#include "condyle/firmware/nonblocking.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/hal/hid/device_profile.h"
#include "condyle/hal/log/session_log.h"
#include "condyle/hal/report/device_facebow.h"
#include "condyle/hal/report/report_tracker.h"
#include "hosted/estimates/learned_motion.h"

namespace condyle::box {

/// Counts of the reports of all runs.
struct EngineCounts {
  std::uint64_t samples = 0, estimates = 0;
  std::uint64_t received = 0, lost = 0, duplicated = 0, unknown_losses = 0, bad = 0;
  std::uint64_t sequence_restarts = 0;
  std::uint64_t disconnections = 0, stalls = 0, transfer_errors = 0, oversized = 0;
};

/// Reads the facebow and estimates, run after run.
class Engine {
 public:
  /// `source`, on `clock`, delivers the reports that `profile` describes; no other code may read
  /// it. With a `feed`, reports go there, and the outlet's estimates come from another thread.
  Engine(ReconnectingSource& source, const hal::DeviceProfile& profile,
         const Configuration& configuration, hal::Clock& clock, NodeFeed* feed = nullptr);
  ~Engine() { stop(); }
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  void start();
  /// Ends the run and the thread. May be called twice.
  void stop();

  /// Ends the run and begins another with a fresh estimator, whose reports go to source 0 of `log`,
  /// or nowhere. Returns the number of the new run once the thread no longer uses the old log. One
  /// thread at a time.
  std::uint64_t begin_run(hal::SessionLogWriter* log);

  EstimateOutlet& outlet() { return outlet_; }
  const EstimateOutlet& outlet() const { return outlet_; }
  const RecommendedParameters& parameters() const { return parameters_; }

  // For any thread:
  EngineCounts counts() const;
  /// Increases at least every 50 ms while the thread works.
  std::uint64_t heartbeat() const { return heartbeat_.load(std::memory_order_relaxed); }
  /// "SCHED_FIFO 50", or why it was refused; empty until the thread runs.
  std::string scheduling() const;
  /// The source is a recording that has ended.
  bool has_ended() const { return has_ended_.load(std::memory_order_relaxed); }
  std::uint64_t run() const { return run_.load(std::memory_order_acquire); }
  /// Reports received before the run that `begin_run` began.
  std::uint64_t received_before_run() const {
    return received_before_run_.load(std::memory_order_relaxed);
  }

  /// What the run before the one that `begin_run` began has learned, if that went to a log and this
  /// goes to none. For the thread that called it, until it calls it again.
  const std::optional<host::LearnedMotion>& learned_before_run() const {
    return learned_before_run_;
  }

 private:
  static constexpr std::size_t kCounts = sizeof(EngineCounts) / sizeof(std::uint64_t);

  void loop();
  void do_run(hal::SessionLogWriter* log);
  template <class Sensor>
  void keep_learned(Sensor& sensor);
  template <class Sensor>
  void estimate_run(hal::DeviceFacebow& facebow, Sensor& sensor);
  bool has_to_leave();
  bool has_next_log() const;
  void track(const hal::DeviceFacebow& facebow) CONDYLE_NONBLOCKING;
  void note_counts(const hal::DeviceFacebow& facebow, std::uint64_t samples);
  void keep_totals();

  ReconnectingSource& source_;
  hal::DeviceProfile profile_;
  RecommendedParameters parameters_;
  FollowedCoordinate followed_;
  bool has_pose_;
  int lag_, priority_;
  hal::Clock& clock_;

  NodeFeed* feed_;
  EstimateOutlet outlet_;

  // Requests to the thread.
  std::atomic<bool> stops_ = false;
  std::atomic<std::uint64_t> wanted_run_ = 1;
  std::atomic<hal::SessionLogWriter*> wanted_log_ = nullptr;
  // Reported by the thread.
  std::atomic<std::uint64_t> run_ = 0, heartbeat_ = 0;
  std::atomic<std::uint64_t> received_before_run_ = 0;     // written before run_
  std::optional<host::LearnedMotion> learned_before_run_;  // written before run_
  std::atomic<bool> has_ended_ = false, is_scheduled_ = false;
  std::array<std::atomic<std::uint64_t>, kCounts> counts_{};
  std::string scheduling_;  // written before is_scheduled_

  // The thread's own. One tracker goes through all runs, so that losses between two runs count too.
  hal::ReportTracker all_runs_;
  std::uint64_t connections_ = 0;
  EngineCounts totals_, present_;
  std::optional<host::LearnedMotion> learned_;  // in the run that has just ended
  std::thread thread_;
};

}  // namespace condyle::box
