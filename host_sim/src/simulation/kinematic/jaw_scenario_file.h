// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "simulation/kinematic/jaw_scenario.h"

namespace condyle::host {

/// True if the TOML file at `path` has the section [kinematic].
bool is_jaw_scenario(const std::string& path);

/// Loads a scenario of a kinematic jaw. Its tasks are those that have a section, in the order of
/// JawTaskKind; missing values keep their defaults. Throws InputError as load_scenario does
/// (simulation/scenario_file.h).
JawScenario load_jaw_scenario(const std::string& path);

}  // namespace condyle::host
