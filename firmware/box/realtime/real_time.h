// SPDX-License-Identifier: Apache-2.0
// What Linux lets a thread have so that nothing else delays it.
#pragma once

#include <string>

namespace condyle::box {

/// Makes the calling thread SCHED_FIFO with `priority` (1 to 98), and touches its stack so that no
/// page of it has to be found later. "SCHED_FIFO 50", or why not.
std::string become_real_time(int priority);

/// Keeps all memory of the process, now and later, in RAM, and keeps the heap from giving any back.
/// "locked", or why not.
std::string lock_memory();

}  // namespace condyle::box
