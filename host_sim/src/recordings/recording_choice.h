// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "recordings/followed_choice.h"
#include "recordings/recording.h"

namespace condyle::host {

/// The user's choice of how to read recordings and what to follow in them.
struct RecordingChoice : FollowedChoice {
  RecordingOptions reading;

  /// Throws InputError if the recording `source` lacks the followed point or axis.
  void check(const std::string& source, const RecordingInfo& info) const {
    FollowedChoice::check(source, info.kind);
  }
};

/// Throws InputError if two of `sources` are the same recording.
void refuse_repeated_recordings(const std::vector<std::string>& sources);

}  // namespace condyle::host
