// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "recordings/named_points.h"

namespace condyle::host {

/// The stream of an XDF file whose channels are places; of several, the one that the first of
/// `options.markers` names, as "STREAM:POINT".
std::unique_ptr<NamedPointsRecording> open_xdf(const std::string& path,
                                               const RecordingOptions& options,
                                               bool takes_any_number);

}  // namespace condyle::host
