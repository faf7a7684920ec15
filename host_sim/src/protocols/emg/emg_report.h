// SPDX-License-Identifier: Apache-2.0
// Friction from EMG: the run over a recording, as text and JSON.
#pragma once

#include <string>

#include "protocols/emg/emg_recording.h"
#include "recordings/recording_choice.h"

namespace condyle::host {

/// The inputs of the identification.
struct EmgSource {
  std::string recording, emg;
  RecordingChoice choice;
  EmgReading emg_reading;
  double noise_sd_m = 5e-5;  ///< of a measured position
  bool keeps_rows = false;   ///< fills EmgResult::rows
};

/// The result of the identification.
struct EmgResult {
  EmgSource source;
  MuscleFile muscles;
  EmgRecording emg;  ///< without its rows
  std::uint64_t emg_rows = 0, positions = 0, positions_missing = 0, positions_in_emg = 0;
  EmgEstimate<double> estimate;
  EmgTimelineCounts counts;
  std::string rows;  ///< CSV, one for each position
};

/// Reads both recordings and identifies with `muscles`. Throws InputError if they cannot be used.
EmgResult identify_from_emg(const EmgSource& source, const MuscleFile& muscles);

/// Its values with provenance, uncertainty and limit.
std::string emg_text(const EmgResult& result);
/// The same as JSON, without withheld values.
std::string emg_json(const EmgResult& result);

}  // namespace condyle::host
