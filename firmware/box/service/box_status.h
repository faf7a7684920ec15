// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "box/outlets/http_server.h"
#include "box/outlets/publisher.h"
#include "box/realtime/engine.h"
#include "box/realtime/node_estimator.h"
#include "box/recording/session_recorder.h"

namespace condyle::box {

/// A snapshot of everything in the status.
struct BoxStatus {
  TimeNs running_ns = 0;
  std::optional<JawPlaces> jaw;  ///< for its picture
  std::string source, device;    ///< kind of the facebow's source, and the profile's name
  bool is_found = false, is_open = false, has_ended = false;
  hal::Status last_status = hal::Status::not_open;
  std::string problem;  ///< why the facebow is not found yet
  std::uint64_t connections = 0;
  double rate_Hz = 0;          ///< of the samples of the last second
  double nominal_rate_Hz = 0;  ///< from the profile; 0: not stated
  EngineCounts counts;
  std::optional<double> assumed_mass_kg;  ///< of the force; none: a microcontroller has its own
  EstimatorHealth health;
  std::uint64_t run = 0, estimates_dropped = 0;
  const firmware::LatencyHistogram* latency = nullptr;  ///< null: there is none yet
  std::string scheduling, memory;
  SessionState session;
  bool records = false;
  PublisherCounts publisher;
  HttpCounts http;
  std::string lsl;  ///< NAME@ADDRESS of the streams of estimates; empty: none
  host::lsl::OutletCounts lsl_counts;
  std::string node;  ///< line to the microcontroller that estimates; empty: none
  NodeState node_state;
  std::uint64_t clock_steps = 0;
  double last_clock_step_s = 0;  ///< of the wall clock
};

/// The status as JSON of the format condyle-box-status-1. Later versions may add fields; a change
/// of meaning gets a new format number.
std::string status_json(const BoxStatus& status);

}  // namespace condyle::box
