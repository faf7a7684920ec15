// SPDX-License-Identifier: Apache-2.0
// A microcontroller as the box's estimator: a thread that sends it the facebow's reports and
// receives its estimates. It never delays the real-time thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "box/box_log.h"
#include "box/configuration.h"
#include "box/realtime/estimate_outlet.h"
#include "box/realtime/node_feed.h"
#include "condyle/hal/clock.h"
#include "condyle/hal/hid/device_profile.h"
#include "hosted/node/node_client.h"

namespace condyle::box {

/// State of the microcontroller. Counts are of all runs.
struct NodeState {
  bool is_connected = false;
  bool is_silent = false;  ///< it has not answered for more than a second
  std::string words;       ///< its greeting
  std::string problem;     ///< why it is away, or the last problem
  std::uint64_t connections = 0;
  std::uint64_t losses = 0;    ///< how often it went away, failed or started again
  std::uint64_t silences = 0;  ///< how often it did not answer for more than a second
  std::uint64_t late = 0;      ///< estimates later than the settings allow
  std::uint64_t not_sent = 0;  ///< reports: it was away, or too slow
  std::uint64_t lost = 0;      ///< reports: on the line, or their estimates, or when it went away
  std::uint64_t without_estimate = 0;                 ///< reports received that led to no estimate
  std::uint64_t frames_refused = 0, frames_lost = 0;  ///< of the frames it sent
  std::optional<hal::HealthMessage> health;           ///< its own counts, of the present run
};

/// Each run of the feed is a run of the microcontroller with a fresh estimator. After the
/// microcontroller was away, a new run begins too.
class NodeEstimator {
 public:
  /// Estimates go to `outlet`, which no other thread may fill; all arguments must outlive this
  /// object.
  NodeEstimator(const Configuration& configuration, const hal::DeviceProfile& profile,
                NodeFeed& feed, EstimateOutlet& outlet, hal::Clock& clock, BoxLog& log);
  ~NodeEstimator() { stop(); }
  NodeEstimator(const NodeEstimator&) = delete;
  NodeEstimator& operator=(const NodeEstimator&) = delete;

  void start();
  void stop();
  NodeState state() const;

 private:
  void loop();
  void do_run();
  void feed(host::NodeClient& client);
  bool has_report();
  void end_run(const host::NodeClient& client);
  void take_answers(host::NodeClient& client, unsigned scalar_size);
  void take(host::NodeClient& client, host::NodeAnswer answer, unsigned scalar_size);
  template <class Scalar>
  void publish(const host::NodeClient& client);
  void watch(host::NodeClient& client);
  void note_counts(const host::NodeClient& client);
  void publish_absence();
  void note_not_sent();
  void note_absence(const std::string& problem);
  void wait_away();

  const std::string port_;
  const unsigned baud_;
  const TimeNs late_ns_;
  hal::ReportLayout layout_;
  hal::StartMessage start_;
  NodeFeed& feed_;
  EstimateOutlet& outlet_;
  hal::Clock& clock_;
  BoxLog& log_;

  std::atomic<bool> stops_ = false;
  mutable std::mutex mutex_;
  NodeState state_;  // guarded by the mutex

  // The thread's own.
  FedReport next_;
  bool has_next_ = false, ends_ = false;
  std::uint64_t run_ = 0, outlet_run_ = 0, not_sent_ = 0;
  std::uint64_t connection_ = 0;  // of the facebow, at the run's last report; 0: none yet
  NodeState before_;              // the counts before the present run
  std::uint64_t estimates_before_ = 0;
  TimeNs pause_ns_ = 0, next_health_ns_ = 0, next_absence_ns_ = 0;
  bool is_silent_ = false;
  std::thread thread_;
};

}  // namespace condyle::box
