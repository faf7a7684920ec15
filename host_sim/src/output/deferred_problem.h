// SPDX-License-Identifier: Apache-2.0
// A problem that does not stop a command: its output is kept, the problem is reported at the end,
// and the command exits as for any other bad input.
#pragma once

#include <string>
#include <vector>

#include "hosted/files/input_error.h"

namespace condyle::host {

/// Stores a problem for the end of the command.
void defer_problem(const InputError& problem);

/// The stored problems, one message each.
const std::vector<std::string>& deferred_problems();

}  // namespace condyle::host
