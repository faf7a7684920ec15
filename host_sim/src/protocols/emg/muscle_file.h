// SPDX-License-Identifier: Apache-2.0
// The muscles whose EMG was recorded, as a TOML file; host_sim/muscles has examples.
#pragma once

#include <string>
#include <vector>

#include "condyle/estimator/emg/emg_envelope.h"
#include "condyle/estimator/emg/emg_timeline.h"

namespace condyle::host {

/// A muscle's EMG channel.
struct EmgChannel {
  std::string muscle;
  std::string column;  ///< of the EMG file
  double maximum = 1;  ///< envelope of a maximal voluntary contraction, in the column's unit
  bool has_maximum = false;
};

/// The content of such a file.
struct MuscleFile {
  MuscleSet set;
  std::vector<EmgChannel> channels;  ///< in the order of the set
  EmgParameters identification;
  EnvelopeParameters envelope;  ///< of raw EMG; without rate and maximum
};

/// Reads it. Every problem is an InputError that names file, line and remedy.
MuscleFile load_muscles(const std::string& path);

}  // namespace condyle::host
