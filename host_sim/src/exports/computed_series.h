// SPDX-License-Identifier: Apache-2.0
// What is computed from a recording and exported beside it.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "exports/export_data.h"
#include "recordings/recording_choice.h"

namespace condyle::host {

/// The name of the series of estimates; condyle does not read columns named after it.
inline constexpr const char* kEstimateName = "estimate";
/// What the numbers of provenance in exported files mean.
inline constexpr const char* kProvenanceCodes = "0 not computed, 1 assumed, 2 derived, 3 measured";

/// Adds data.estimates, at the times of the samples: position, velocity, acceleration and force,
/// with a drive also friction and mass, each with standard deviation and the provenance of each
/// value. A note counts estimates at no sample's time.
void add_estimate_series(ExportData& data);

/// Adds the pose of the jaw that three points form: the place of the first, and the orientation.
/// A note, where the recording holds poses. Throws InputError if there is none.
void add_pose_series(ExportData& data);

/// Where landmarks hold.
struct LandmarkChoice {
  std::string file;                                  ///< TOML; empty: none
  std::optional<std::array<double, 2>> reference_s;  ///< as of analyse; empty: found
};

/// Adds the condylar points and the lower incisor of the file, which move with the jaw from the
/// reference position on, in the instrument's frame. Throws InputError if that is not possible.
void add_landmark_series(const LandmarkChoice& choice, const RecordingOptions& reading,
                         ExportData& data);

}  // namespace condyle::host
