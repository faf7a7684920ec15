// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "recordings/recording_choice.h"
#include "tuning/matching_criterion.h"

namespace condyle::host {

/// The positions of `path` as used by the published cascade (published_sensor.h), at most its first
/// `most_samples`. Its sample time is `sample_time_s`, or if there is none its median step. Throws
/// InputError if it cannot be read. Calls `show(share)`, 0 to 1, during the work; `should_stop()`
/// may end it.
PublishedRecording read_for_published(const std::string& path, const RecordingChoice& choice,
                                      std::optional<double> sample_time_s, std::size_t most_samples,
                                      const std::function<void(double)>& show,
                                      const std::function<bool()>& should_stop);

}  // namespace condyle::host
