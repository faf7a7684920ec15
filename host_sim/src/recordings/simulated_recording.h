// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "recordings/recording.h"
#include "simulation/simulation.h"

namespace condyle::host {

/// The scenario at `path`, simulated while it is read: a facebow without hardware.
std::unique_ptr<Recording> open_simulation(const std::string& path);
/// The same for a scenario that is no file.
std::unique_ptr<Recording> open_simulation(const Scenario& scenario);

}  // namespace condyle::host
