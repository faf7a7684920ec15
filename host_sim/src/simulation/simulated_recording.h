// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "recording.h"

namespace condyle::host {

/// The scenario at `path`, simulated while it is read: a facebow without hardware.
std::unique_ptr<Recording> open_simulation(const std::string& path);

}  // namespace condyle::host
