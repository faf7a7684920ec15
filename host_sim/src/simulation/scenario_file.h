// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "simulation/simulation.h"

namespace condyle::host {

/// Loads a scenario from TOML (host_sim/scenarios). What the file leaves out keeps the defaults of
/// the structs in simulation/. Everything in it must be known and in range; else an InputError
/// names line, column and mend.
Scenario load_scenario(const std::string& path);

}  // namespace condyle::host
