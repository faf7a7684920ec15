// SPDX-License-Identifier: Apache-2.0
// The stretch of a recording in which a relaxed jaw was let go.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "options/recording_choice.h"

namespace condyle::host {

/// Which stretch of which recording.
struct ReleaseSource {
  std::string recording;
  RecordingChoice choice;
  /// From the recording's first time (s); without a begin it is looked for, without an end it is
  /// kReleaseDuration_s later.
  std::optional<double> begin_s, end_s;
  double let_go_s = 0;  ///< the hand lets go over this time after the begin, which is left out
};

/// Before the masseter reflex and its like move the jaw on.
inline constexpr double kReleaseDuration_s = 0.6;

/// The samples of a release.
struct ReleaseStretch {
  std::vector<double> time_s;  ///< from the recording's first time
  std::vector<double> position_m;
  std::vector<double> all_time_s, all_position_m;  ///< of the whole recording, for pictures
  bool was_found = false;                          ///< begin was looked for
};

/// Longest recording that is read.
inline constexpr std::size_t kMostReleaseSamples = 1'000'000;

/// Reads it. Throws InputError if there is no such stretch, or more than one.
ReleaseStretch read_release(const ReleaseSource& source);

/// Samples with which a motion begins after a still stretch of at least 0.15 s: the first sample
/// that has left it by 5 % of all motion. A late begin only loses a little, an early one is wrong.
std::vector<std::size_t> find_motion_begins(const std::vector<double>& time_s,
                                            const std::vector<double>& position_m);

}  // namespace condyle::host
