// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "command_line.h"
#include "commands.h"

namespace condyle::host {

/// `condyle protocol emg`
Command add_emg(CommandLine app);

}  // namespace condyle::host
