// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "options/command_line.h"
#include "recordings/followed_choice.h"
#include "recordings/recording.h"

namespace condyle::host {

/// What --profile means in every command.
inline constexpr const char* kProfileMeaning =
    "TOML file that describes the device and the meaning of its reports";

/// Whether a command can follow points of the jaw in addition to those of the instrument.
enum class JawPoints { no, yes };

/// Gives `command` --point, --axis and --jaw-point-mm, which fill `choice`; it must outlive them.
void add_followed_options(CommandLine command, FollowedChoice& choice,
                          JawPoints jaw_points = JawPoints::yes);

/// Gives `command` --ignore-column, --profile, --unit and --movement, which fill `reading`; it must
/// outlive them.
void add_reading_options(CommandLine command, RecordingOptions& reading);

/// The user's choice of how to read recordings and what to follow in them.
struct RecordingChoice : FollowedChoice {
  RecordingOptions reading;

  /// Gives `command` the options above and --faults, --ignore-column, --profile, --unit and
  /// --movement, which fill this; it must outlive them.
  void add_to(CommandLine command, JawPoints jaw_points = JawPoints::yes);
  /// Throws InputError if the recording `source` lacks the followed point or axis.
  void check(const std::string& source, const RecordingInfo& info) const {
    FollowedChoice::check(source, info.kind);
  }
};

/// Throws InputError if two of `sources` are the same recording.
void refuse_repeated_recordings(const std::vector<std::string>& sources);

}  // namespace condyle::host
