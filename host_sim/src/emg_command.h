// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.h"

namespace condyle::host {

/// `condyle protocol emg`
Command add_emg(CLI::App& app);

}  // namespace condyle::host
