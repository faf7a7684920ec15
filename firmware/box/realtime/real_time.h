// SPDX-License-Identifier: Apache-2.0
// Linux settings that keep other programs from delaying a thread.
#pragma once

#include <string>

namespace condyle::box {

/// Makes the calling thread SCHED_FIFO with `priority` (1 to 98), and touches its stack so that
/// none of its pages is missing later. Returns "SCHED_FIFO 50", or why it was refused.
std::string become_real_time(int priority);

/// Locks the memory of the process in RAM: what it has now at once, later pages from their first
/// use on. Keeps the heap from returning memory. Returns "locked", or why not.
std::string lock_memory();

}  // namespace condyle::box
