// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.h"

namespace condyle::host {

/// `condyle protocol plan-head-motion`
Command add_plan_head_motion(CLI::App& protocol);
/// `condyle protocol head-motion`
Command add_head_motion(CLI::App& protocol);

}  // namespace condyle::host
