// SPDX-License-Identifier: Apache-2.0
// The values of chewing cycles and their uncertainty, computed on all cores.
#pragma once

#include <cstddef>
#include <vector>

#include "readings/chewing_cycles.h"
#include "readings/task_readings.h"
#include "readings/uncertainty.h"

namespace condyle::host {

/// Half windows of a calm path and a mild one (s). A cycle turns sharply where the jaw is closed: a
/// calm path shows a third of what smoothing changes.
inline constexpr double kCalmCycle_s = 0.06, kMildCycle_s = 0.1, kTimesSmoothingOfCycle = 3;

/// A cycle of a path, and the standard deviation of the path's smoothed heights there.
struct CycleToRead {
  ChewingCycle cycle;
  double height_sd_m = 0;
};

/// The values of read_cycle for each of `cycles`, samples of the motion of `context`. Each draws
/// noise of its own: the values do not depend on `threads` (0: one for each core).
std::vector<std::vector<UncertainValue>> values_of_cycles(const std::vector<CycleToRead>& cycles,
                                                          const TaskContext& context,
                                                          unsigned threads = 0);

}  // namespace condyle::host
