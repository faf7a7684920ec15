// SPDX-License-Identifier: Apache-2.0
// The part of a recording in which a relaxed jaw was released.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recordings/recording_choice.h"

namespace condyle::host {

/// The part of a recording.
struct ReleaseSource {
  std::string recording;
  RecordingChoice choice;
  /// From the recording's first time (s). Without a begin it is detected; without an end it is
  /// kReleaseDuration_s later.
  std::optional<double> begin_s, end_s;
  double let_go_s = 0;  ///< time that the hand takes to let go after the begin; left out
};

/// Ends before reflexes, such as the masseter's, move the jaw.
inline constexpr double kReleaseDuration_s = 0.6;

/// The samples of a release.
struct ReleaseStretch {
  std::vector<double> time_s;  ///< from the recording's first time
  std::vector<double> position_m;
  std::vector<double> all_time_s, all_position_m;  ///< of the whole recording, for figures
  bool was_found = false;                          ///< the begin was detected
};

/// Maximum number of samples of a recording.
inline constexpr std::size_t kMostReleaseSamples = 1'000'000;

/// Reads it. Throws InputError if there is no release, or more than one.
ReleaseStretch read_release(const ReleaseSource& source);

/// Samples at which a motion begins after at least 0.15 s at rest: the first sample away from the
/// rest by 5 % of the whole motion. A late begin loses little precision, but an early one gives
/// wrong values.
std::vector<std::size_t> find_motion_begins(const std::vector<double>& time_s,
                                            const std::vector<double>& position_m);

}  // namespace condyle::host
