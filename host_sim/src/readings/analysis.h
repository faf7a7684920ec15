// SPDX-License-Identifier: Apache-2.0
// The readings of a recording.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "readings/average_cycle.h"
#include "readings/body_tracks.h"
#include "readings/chewing_cycles.h"
#include "readings/pose_noise.h"
#include "readings/pose_track.h"
#include "readings/reading.h"
#include "readings/reading_geometry.h"
#include "readings/tasks.h"
#include "recordings/recording_choice.h"

namespace condyle::host {

/// What to analyse, and how.
struct AnalysisChoice {
  RecordingOptions reading;
  std::string landmarks;                             ///< TOML file; empty: none
  std::vector<Task> tasks;                           ///< stated; none: marked or found
  std::optional<std::array<double, 2>> reference_s;  ///< begin and end of the reference position
  MovingBody moving = MovingBody::lower;
  BodyChoice bodies;
};

/// A cycle of a chewing task, with its values in the order of readings_of_cycle.
struct AnalysedCycle {
  ChewingCycle cycle;
  std::vector<UncertainValue> values;
  int number = 0;    ///< of those taken, from 1; 0: rejected
  int sequence = 1;  ///< a pause of more than 2 s begins a new one
  std::string side;  ///< left, right or midline; empty: not known
  CycleDirections directions{};
  bool is_side_stated = false;  ///< with the task; else by the closing path
  std::string assumed;          ///< what it assumes about unused samples; empty if nothing
};

/// Everything about one recording.
struct Analysis {
  std::string recording;
  RecordingInfo info;
  PoseCounts counts;
  std::vector<std::string> events, notes;
  std::string unusable;  ///< why no reading can be trusted; empty: usable
  bool has_landmarks = false;
  double duration_s = 0, rate_Hz = 0;
  double reference_begin_s = 0, reference_end_s = 0;
  bool is_reference_found = false;
  PoseNoise noise;
  double largest_rotation_deg = 0, largest_displacement_mm = 0;
  std::vector<Task> tasks;
  std::vector<JawReading> readings;
  std::vector<AnalysedCycle> cycles;
  std::vector<AverageCycle> average_cycles;  ///< of all cycles, and of each side
  JawPath path;                              ///< of the whole recording, smoothed
  std::vector<double> incisor_sd_m;  ///< of each smoothed position, root of the mean variance
};

/// Analyses the recording at `source`. Throws InputError if it, or the landmarks, cannot be used.
Analysis analyse(const std::string& source, const AnalysisChoice& choice);
/// The same for an open recording and given landmarks; messages call it `name`.
Analysis analyse(Recording& recording, const std::string& name,
                 const std::optional<Landmarks>& landmarks, const AnalysisChoice& choice);

}  // namespace condyle::host
