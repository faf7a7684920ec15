// SPDX-License-Identifier: Apache-2.0
// The settings in the box's configuration file. box.toml documents them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/estimator/sample.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "condyle/hal/log/session_log.h"
#include "hosted/devices/source_spec.h"
#include "hosted/devices/stream_spec.h"
#include "hosted/estimates/followed_cycles.h"
#include "hosted/estimates/pose_choice.h"

namespace condyle::box {

/// Where reports come from: any source except a simulated subject. A recording must be a session
/// log; it is played at its recorded speed.
struct SourceSettings {
  using Kind = host::SourceKind;
  std::string name;  ///< "facebow", or a companion's
  Kind kind = Kind::synth;
  std::string file;
  std::string serial;                      ///< of a device; empty: any device
  std::optional<host::StreamSpec> stream;  ///< instead of kind and file
};

/// Where the jaw's points are in its reference position (mm), and the head's axes forward, left and
/// up, in the instrument's frame.
struct JawPlaces {
  using Vector = std::array<double, 3>;
  Vector condyle_left_mm{}, condyle_right_mm{}, incisor_mm{};
  std::array<Vector, 3> axes{};
};

/// All settings, with their defaults.
struct Configuration {
  SourceSettings facebow;
  FollowedCoordinate followed;
  std::vector<SourceSettings> companions;

  RecommendedParameters parameters;
  std::string parameters_toml;  ///< as the file gives them, for the log
  int lag = 0;                  ///< samples
  std::string node;             ///< line to the microcontroller that estimates; empty: the box does
  unsigned node_baud = 1'000'000;
  TimeNs node_late_ns = 100'000'000;  ///< a later estimate counts as late

  std::optional<host::PoseChoice> pose;  ///< empty: the whole pose is not estimated

  std::optional<JawPlaces> jaw;  ///< for its picture; empty: assumed. Not in the file

  std::optional<host::CycleChoice> cycles;  ///< empty: chewing cycles are not found

  int priority = 50;         ///< SCHED_FIFO; 0: an ordinary thread
  bool locks_memory = true;  ///< if permitted; not in the file

  std::string folder;                         ///< for recordings; empty: recording is off
  std::uint64_t reserve_bytes = 256'000'000;  ///< of disk space that are never used
  hal::SessionLogOptions log;                 ///< not in the file: for tests with their own clock
  /// Not in the file: makes a report (HTML) of a session log; throws if it cannot. Empty: no
  /// reports.
  std::function<std::string(const std::string& file)> make_report;

  std::string udp_address = "127.0.0.1";
  std::uint16_t udp_port = 0;  ///< 0: nothing is sent
  std::string lsl_out;  ///< NAME@ADDRESS of the streams of estimates and markers; empty: none
  std::string http_address = "127.0.0.1";
  std::uint16_t http_port = 8750;     ///< 0: any that is free
  std::string token;                  ///< empty: no token is required
  std::uint16_t most_listeners = 16;  ///< to estimates over HTTP, at the same time
};

/// Reads a configuration. An InputError contains place, problem and remedy. Relative file names are
/// resolved against the folder of the configuration file.
Configuration load_configuration(const std::string& path);

/// True for numeric addresses that no other machine can reach.
bool is_loopback(std::string_view address);

}  // namespace condyle::box
