// SPDX-License-Identifier: Apache-2.0
// C3D files: points and analogue channels of motion capture.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/analog_channels.h"
#include "recordings/named_points.h"

namespace condyle::host {

/// True if `reader`, at the beginning of a file, has the header and the parameter section of a C3D
/// file. What was peeked before is no longer valid.
bool looks_like_c3d(ByteReader& reader);

/// The points of a C3D file.
std::unique_ptr<NamedPointsRecording> open_c3d(std::unique_ptr<ByteReader> reader,
                                               const RecordingOptions& options);

/// The analogue channels `names` of a C3D file.
std::unique_ptr<AnalogReader> open_c3d_analog(std::unique_ptr<ByteReader> reader,
                                              const std::vector<std::string>& names,
                                              FaultPolicy faults);

}  // namespace condyle::host
