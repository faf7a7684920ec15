// SPDX-License-Identifier: Apache-2.0
// EMG channels recorded together with the position, at their own rate, on its clock.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "protocols/emg/muscle_file.h"
#include "recordings/recording.h"

namespace condyle::host {

/// How to read EMG.
struct EmgReading {
  FaultPolicy faults = FaultPolicy::refuse;
  bool is_raw = false;                ///< otherwise envelopes
  std::optional<double> raw_maximum;  ///< for muscles without their own maximum
};

/// Excitations of all muscles at one instant.
struct EmgRow {
  TimeNs time_ns = 0;
  std::array<double, kMostMuscles> excitation{};  ///< share of the maximum; NaN: not known
};

/// An EMG file.
struct EmgRecording {
  std::vector<EmgRow> rows;
  double rate_Hz = 0;  ///< by the median step
  double delay_s = 0;  ///< of the envelopes, by the filters of raw EMG
  std::uint64_t rows_without_time = 0, missing_values = 0, above_maximum = 0;
  EnvelopeCounts envelope;  ///< of all raw channels
};

/// Longest EMG that is read.
inline constexpr std::size_t kMostEmgRows = 2'000'000;

/// Reads what `muscles` names from the file `path`: of CSV time_s and a column for each muscle, of
/// a recording with analogue channels a channel for each, in its unit; ignores the others. Problems
/// are InputErrors that name file, line, column and remedy.
EmgRecording read_emg(const std::string& path, const MuscleFile& muscles,
                      const EmgReading& reading);

}  // namespace condyle::host
