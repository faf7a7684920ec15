// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hosted/files/toml_reader.h"
#include "simulation/instrument.h"

namespace condyle::host {

/// Reads [facebow] of a scenario, except `gives`.
void read_facebow(TomlReader& file, FacebowModel& facebow);

}  // namespace condyle::host
