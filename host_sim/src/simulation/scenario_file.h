// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "simulation/simulation.h"

namespace condyle::host {

/// Loads a scenario from TOML (host_sim/scenarios). Missing values keep the defaults of the structs
/// in simulation/. All keys must be known and all values in range; otherwise an InputError names
/// line, column and remedy.
Scenario load_scenario(const std::string& path);

}  // namespace condyle::host
