// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "box/box_log.h"
#include "box/configuration.h"
#include "box/outlets/estimate_history.h"
#include "box/outlets/http_server.h"
#include "box/outlets/publisher.h"
#include "box/realtime/engine.h"
#include "box/realtime/node_estimator.h"
#include "box/realtime/node_feed.h"
#include "box/recording/session_files.h"
#include "box/recording/session_keeper.h"
#include "box/service/box_status.h"
#include "condyle/hal/clock.h"
#include "hosted/devices/configured_facebow.h"
#include "hosted/files/wall_clock.h"

namespace condyle::box {

/// The facebow that `settings` name; throws an InputError.
host::ConfiguredFacebow configured(const SourceSettings& settings, hal::Clock& clock);

/// The service: one facebow, its estimates, its outlets, its recordings.
class Box {
 public:
  /// Opens what the configuration names, and listens; throws an InputError if that fails. The
  /// facebow may be absent. `wall_ns` gives the time of day, to notice when it is set.
  Box(const Configuration& configuration, hal::Clock& clock, BoxLog& log,
      std::function<TimeNs()> wall_ns = host::wall_ns);
  ~Box();
  Box(const Box&) = delete;
  Box& operator=(const Box&) = delete;

  /// Works until `should_stop`, on this thread and others; then ends a running session and
  /// everything else. Call it once.
  void run(const std::function<bool()>& should_stop);

  /// After `run`: true if the disk does not respond. The end of the session is then not written,
  /// and the destructor would wait for it: end the program at once.
  bool is_held_by_disk() const { return is_held_by_disk_; }

  std::uint16_t http_port() const { return http_.port(); }
  BoxStatus status() const;

 private:
  bool find_facebow(const std::function<bool()>& should_stop);
  void open_stream();
  void look_after(TimeNs now_ns);
  void watch_device(TimeNs now_ns);
  bool take_wall_offset(TimeNs& offset_ns) const;
  void watch_wall_clock();
  void feed_watchdog(TimeNs now_ns);
  void measure_rate(TimeNs now_ns);
  HttpServer::Service service();
  std::string recorded_file() const;
  SessionKeeper::Then then_mark(const std::string& text, SessionKeeper::Then then);
  void mark(const std::string& text);

  Configuration configuration_;
  hal::Clock& clock_;
  BoxLog& log_;
  const std::function<TimeNs()> wall_ns_;
  TimeNs begin_ns_;
  host::ConfiguredFacebow facebow_;
  const std::string device_name_;  // copied: finding the device changes the profile
  const double nominal_rate_Hz_;
  SessionKeeper keeper_;
  const SessionFiles files_;
  EstimateHistory history_;
  Publisher publisher_;
  // Set once the facebow is found.
  std::unique_ptr<ReconnectingSource> source_;
  std::unique_ptr<NodeFeed> feed_;  // these two only if a microcontroller estimates
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<NodeEstimator> node_;
  std::unique_ptr<host::lsl::EstimateStream> stream_;  // only if it is configured
  std::atomic<bool> is_found_ = false;
  bool is_held_by_disk_ = false;

  mutable std::mutex mutex_;
  std::string problem_, memory_;  // guarded by the mutex
  std::atomic<double> rate_Hz_ = 0, last_clock_step_s_ = 0;
  std::atomic<std::uint64_t> clock_steps_ = 0;

  // Used by the thread in run().
  bool was_open_ = true, has_opened_ = false;
  TimeNs found_ns_ = 0;
  TimeNs rate_begin_ns_ = 0, next_watchdog_ns_ = 0, wall_offset_ns_ = 0;
  std::uint64_t rate_samples_ = 0, last_heartbeat_ = 0;

  HttpServer http_;  // last, because its thread uses all the others
};

}  // namespace condyle::box
