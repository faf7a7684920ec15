// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "condyle/estimator/sample.h"
#include "options/command_line.h"
#include "recordings/recording.h"

namespace condyle::host {

/// How a command reads recordings and what of them it follows, as its options say.
struct RecordingChoice {
  FollowedCoordinate followed;
  bool axis_given = false;
  RecordingOptions reading;

  /// Gives `command` --point, --axis, --faults, --ignore-column, --profile, --unit and --movement,
  /// which fill this; it must outlive them.
  void add_to(CommandLine command);
  /// An InputError where the recording `source` does not have what is to be followed.
  void check(const std::string& source, const RecordingInfo& info) const;
};

/// An InputError where two of `sources` are one recording.
void refuse_repeated_recordings(const std::vector<std::string>& sources);

}  // namespace condyle::host
