// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "command_line.h"
#include "commands.h"

namespace condyle::host {

/// `condyle protocol plan-head-motion`
Command add_plan_head_motion(CommandLine protocol);
/// `condyle protocol head-motion`
Command add_head_motion(CommandLine protocol);

}  // namespace condyle::host
