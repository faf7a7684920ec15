// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

namespace condyle::host {

/// Exit code where memory or threads are used up.
inline constexpr int kExitNoRoom = 2;

/// What `error` is, as a sentence on the error output, and the exit code: kExitNoRoom where memory
/// or threads are used up, else `otherwise`. Takes no memory.
int say_last_words(const char* program, const std::exception& error, int otherwise) noexcept;

/// From now on a thread that an exception leaves ends the program so, and not with a signal.
void end_with_last_words(const char* program, int otherwise) noexcept;

}  // namespace condyle::host
