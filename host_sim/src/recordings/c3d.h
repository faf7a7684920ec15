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

/// True if `start`, the beginning of a file, is that of a C3D file.
bool looks_like_c3d(std::string_view start);

/// The points of a C3D file.
std::unique_ptr<NamedPointsRecording> open_c3d(std::unique_ptr<ByteReader> reader,
                                               const RecordingOptions& options);

/// The analogue channels `names` of a C3D file.
std::unique_ptr<AnalogReader> open_c3d_analog(std::unique_ptr<ByteReader> reader,
                                              const std::vector<std::string>& names,
                                              FaultPolicy faults);

}  // namespace condyle::host
