// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/commands.h"
#include "options/command_line.h"

namespace condyle::host {

/// `condyle protocol plan-head-motion`
Command add_plan_head_motion(CommandLine protocol);
/// `condyle protocol head-motion`
Command add_head_motion(CommandLine protocol);

}  // namespace condyle::host
