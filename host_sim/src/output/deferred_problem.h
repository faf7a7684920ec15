// SPDX-License-Identifier: Apache-2.0
// A problem that does not stop a command: what it writes and prints is kept, the problem is told
// after it, and the command exits as for any other bad input.
#pragma once

#include <string>
#include <vector>

#include "hosted/files/input_error.h"

namespace condyle::host {

/// Keeps a problem for the end of the command.
void defer_problem(const InputError& problem);

/// What was kept, a message each.
const std::vector<std::string>& deferred_problems();

}  // namespace condyle::host
