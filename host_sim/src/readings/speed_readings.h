// SPDX-License-Identifier: Apache-2.0
// The speed readings of strokes and chewing cycles, by SpeedReader.
#pragma once

#include <vector>

#include "readings/cycle_values.h"
#include "readings/reading_values.h"
#include "readings/task_readings.h"

namespace condyle::host {

/// Replaces the speeds among the `values` of the readings `names` of a stroke. `path`: of the whole
/// recording.
void read_speeds_of_stroke(const std::vector<StrokeReading>& names, const JawPath& path,
                           SampleRun stroke, const TaskContext& context,
                           std::vector<UncertainValue>& values);

/// Replaces those of a cycle.
void read_speeds_of_cycle(const ChewingCycle& cycle, const TaskContext& context,
                          std::vector<UncertainValue>& values);

}  // namespace condyle::host
