// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "recordings/recording.h"
#include "simulation/simulation.h"

namespace condyle::host {

/// The scenario at `path`, simulated while it is read.
std::unique_ptr<Recording> open_simulation(const std::string& path);
/// The same for a scenario without a file.
std::unique_ptr<Recording> open_simulation(const Scenario& scenario);

}  // namespace condyle::host
