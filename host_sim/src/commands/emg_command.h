// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/commands.h"
#include "options/command_line.h"

namespace condyle::host {

/// `condyle protocol emg`
Command add_emg(CommandLine app);

}  // namespace condyle::host
