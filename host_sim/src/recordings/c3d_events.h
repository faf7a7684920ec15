// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "recordings/c3d_parameters.h"
#include "recordings/recording.h"

namespace condyle::host {

/// The events of the group EVENT of a C3D file, or, if it has none, those of its `header`. Their
/// times are on the clock of the file: 0 is that of frame 1.
std::vector<NamedInstant> c3d_events(std::string_view header, C3dProcessor processor,
                                     const C3dParameters& parameters);

}  // namespace condyle::host
