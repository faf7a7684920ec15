// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "box/outlets/estimate_history.h"
#include "box/realtime/box_estimate.h"
#include "condyle/hal/clock.h"
#include "hosted/estimates/followed_cycles.h"
#include "hosted/estimates/pose_choice.h"
#include "hosted/lsl/estimate_stream.h"

namespace condyle::box {

/// Counts of the estimates to be sent.
struct PublisherCounts {
  std::uint64_t published = 0, datagrams = 0;
  std::uint64_t datagrams_failed = 0;  ///< the network did not accept it, or there is no listener
};

/// Takes estimates from the ring on its own thread, sends each as a UDP datagram with one line of
/// JSON and to a stream, if there is one, and keeps the latest. It never delays the real-time
/// thread.
class Publisher {
 public:
  /// `port` 0 sends nothing. Throws an InputError if `address` cannot be sent to. `pose`: what is
  /// shown of the whole pose. `cycles`: if given, chewing cycles are found and sent as they end.
  Publisher(EstimateHistory& history, const std::string& address, std::uint16_t port,
            hal::Clock& clock, host::PoseChoice pose = {},
            std::optional<host::CycleChoice> cycles = {});
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Also gives them to `stream`, which must outlive the publisher's work; call it before start.
  void also_send(host::lsl::EstimateStream& stream) { stream_ = &stream; }

  /// `tick` is called after new estimates were added to the history: every 5 ms, and more often if
  /// many arrived.
  void start(EstimateRing& ring, std::function<void()> tick);
  /// Publishes what is left.
  void stop();

  PublisherCounts counts() const;

 private:
  bool take_some();  // true when none are left
  std::optional<host::FoundCycle> cycle_at(const BoxEstimate& estimate);

  EstimateHistory& history_;
  hal::Clock& clock_;
  const host::PoseChoice pose_;
  const std::optional<host::CycleChoice> cycle_choice_;
  std::optional<host::FollowedCycles> cycles_;  // of the run
  std::uint64_t run_ = 0, connection_ = 0;      // of the last estimate
  int socket_ = -1;
  host::lsl::EstimateStream* stream_ = nullptr;
  EstimateRing* ring_ = nullptr;
  std::function<void()> tick_;
  std::atomic<bool> stops_ = false;
  std::atomic<std::uint64_t> published_ = 0, datagrams_ = 0, datagrams_failed_ = 0;
  std::thread thread_;
};

}  // namespace condyle::box
