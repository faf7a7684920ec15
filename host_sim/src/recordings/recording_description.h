// SPDX-License-Identifier: Apache-2.0
// What a recording holds, before anything is computed from it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "recordings/recording.h"

namespace condyle::host {

/// What a recording holds of one point, or of one axis.
struct PointDescription {
  std::string name;
  std::uint64_t missing = 0;                ///< samples without it
  std::uint64_t gaps = 0;                   ///< runs of such samples
  std::uint64_t longest_gap = 0;            ///< samples of the longest run
  std::uint64_t zeros = 0;                  ///< samples at exactly 0, 0, 0
  std::array<double, 3> low_m{}, high_m{};  ///< of each axis, where it is there

  bool is_there(std::uint64_t samples) const { return missing < samples; }
};

/// What a recording holds.
struct RecordingDescription {
  RecordingInfo info;
  std::uint64_t samples = 0;
  double first_s = 0, last_s = 0;  ///< times of the first and the last sample with a time
  std::optional<double> rate_Hz;   ///< as stated, or of the mean step without gaps
  std::uint64_t time_missing = 0, time_reversed = 0;
  std::uint64_t time_gaps = 0;  ///< steps of more than one and a half of the median
  std::uint64_t drive = 0;      ///< samples with a drive
  std::size_t axes = 3;         ///< of each point
  std::vector<PointDescription> points;
};

/// Reads `recording` to its end, or until `is_stopped`. Throws InputError for what it cannot read.
RecordingDescription describe_recording(Recording& recording,
                                        const std::function<bool()>& is_stopped);

}  // namespace condyle::host
