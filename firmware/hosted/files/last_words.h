// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

namespace condyle::host {

/// Exit code if memory or threads are exhausted.
inline constexpr int kExitNoRoom = 2;

/// Prints `error` as a sentence on the error output and returns the exit code: kExitNoRoom if
/// memory or threads are exhausted, else `otherwise`. Allocates no memory.
int say_last_words(const char* program, const std::exception& error, int otherwise) noexcept;

/// From now on, an exception that leaves a thread ends the program this way, not with a signal.
void end_with_last_words(const char* program, int otherwise) noexcept;

}  // namespace condyle::host
