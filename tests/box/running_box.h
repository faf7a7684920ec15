// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "box/service/box.h"
#include "support/http_client.h"
#include "support/paced_clock.h"
#include "support/paths.h"
#include "support/temporary_folder.h"
#include "support/wait_for.h"

namespace condyle::testing_support {

/// A box on a synthetic facebow, or any other, in this process. Its time passes faster than the
/// machine's, but nearly stands still while who takes its estimates and reports is behind: so it
/// loses none, however busy the machine.
class RunningBox {
 public:
  explicit RunningBox(double speed = 10, TimeNs origin_ns = 0) : clock(speed, origin_ns) {
    configuration.facebow = {"facebow", box::SourceSettings::Kind::synth,
                             testing_support::source_path("/hal/profiles/condyle_facebow.toml"),
                             ""};
    configuration.folder = folder.path().string();
    configuration.reserve_bytes = 1'000'000;
    configuration.http_port = 0;
  }
  ~RunningBox() { stop(); }
  RunningBox(const RunningBox&) = delete;
  RunningBox& operator=(const RunningBox&) = delete;

  void start() {
    box = std::make_unique<box::Box>(configuration, clock, log,
                                     [this] { return wall_offset_ns + clock.now_ns(); });
    port = box->http_port();
    pacer_ = std::thread([this] { pace(); });
    thread_ = std::thread([this] { box->run([this] { return stops_.load(); }); });
  }
  void stop() {
    stops_ = true;
    if (thread_.joinable()) thread_.join();
    has_stopped_ = true;
    if (pacer_.joinable()) pacer_.join();
  }

  /// Its time nearly stands still once so much of it has passed, until `go_on`.
  void pause_after(TimeNs duration_ns) { pause_ns_ = clock.now_ns() + duration_ns; }
  void pause() { pause_after(0); }
  void go_on() { pause_ns_ = std::numeric_limits<TimeNs>::max(); }

  nlohmann::json status() const {
    return nlohmann::json::parse(get(port, "/v1/status").body, nullptr, false);
  }
  /// Waits for the first estimates.
  bool is_estimating() const {
    return wait_for([this] { return box->status().counts.estimates > 0; });
  }

  /// Of recordings: a session's start and end wait for the disk, which others may keep busy.
  TemporaryFolder folder{TemporaryFolder::in_memory()};
  box::Configuration configuration;
  PacedClock clock;
  box::BoxLog log{clock};
  std::unique_ptr<box::Box> box;
  std::uint16_t port = 0;
  std::atomic<TimeNs> wall_offset_ns = 0;  ///< how far the wall clock is ahead of `clock`
  /// False while a microcontroller is late because the test wants it.
  std::atomic<bool> waits_for_node = true;
  static constexpr std::uint64_t kNobodyListens = std::numeric_limits<std::uint64_t>::max();
  /// Number of the last line that a listener has taken which must not miss any.
  std::atomic<std::uint64_t> listened = kNobodyListens;

 private:
  // What may be on its way, far less than there is room for; of reports to a microcontroller so few
  // that their estimates are on time.
  static constexpr std::int64_t kMostEstimates = 500, kMostRecorded = 1500, kMostLines = 5000;
  static constexpr std::int64_t kMostForNode = 10;
  static constexpr TimeNs kStep_ns = 200'000'000, kStepWithNode_ns = 20'000'000;

  void pace() {
    const TimeNs step_ns = configuration.node.empty() ? kStep_ns : kStepWithNode_ns;
    while (!has_stopped_) {
      const TimeNs left_ns = pause_ns_ - clock.now_ns();
      if (!is_behind()) clock.allow(std::clamp<TimeNs>(left_ns, 0, step_ns));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  bool is_behind() {
    const box::BoxStatus status = box->status();
    const auto published = static_cast<std::int64_t>(status.publisher.published);
    const auto estimates = static_cast<std::int64_t>(status.counts.estimates);
    const auto received = static_cast<std::int64_t>(status.counts.received);
    const auto dropped = static_cast<std::int64_t>(status.estimates_dropped);
    if (estimates - published - dropped > kMostEstimates) return true;
    if (listened < status.publisher.published &&
        published - static_cast<std::int64_t>(listened) > kMostLines) {
      return true;
    }
    const box::NodeState& node = status.node_state;
    const auto given_up = static_cast<std::int64_t>(node.not_sent + node.lost);
    const bool owes = node_owes(
        received - estimates - given_up - static_cast<std::int64_t>(node.without_estimate),
        estimates);
    if (node.is_connected && waits_for_node && owes) return true;
    const box::SessionState& session = status.session;
    if (session.phase != box::SessionState::Phase::recording) return false;
    const auto recorded = static_cast<std::int64_t>(session.reports_written + session.reports_lost);
    if (session.file != file_) {
      file_ = session.file;
      received_before_ = received - recorded;
    }
    return received - received_before_ - recorded > kMostRecorded;
  }

  // `owed` may hold reports of which the box says later that they will have no estimate: these are
  // those that are left after ten seconds without any.
  bool node_owes(std::int64_t owed, std::int64_t estimates) {
    const auto now = std::chrono::steady_clock::now();
    if (estimates != estimates_) progress_ = now;
    estimates_ = estimates;
    hopeless_ = now - progress_ > std::chrono::seconds(10) ? owed : std::min(hopeless_, owed);
    return owed - hopeless_ > kMostForNode + configuration.lag;
  }

  std::atomic<bool> stops_ = false, has_stopped_ = false;
  std::atomic<TimeNs> pause_ns_ = std::numeric_limits<TimeNs>::max();
  // The pacer's.
  std::string file_;
  std::int64_t received_before_ = 0;  // the session, its files and its pauses
  std::int64_t estimates_ = 0, hopeless_ = 0;
  std::chrono::steady_clock::time_point progress_ = std::chrono::steady_clock::now();
  std::thread thread_, pacer_;
};

}  // namespace condyle::testing_support
