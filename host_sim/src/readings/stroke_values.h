// SPDX-License-Identifier: Apache-2.0
// The values of strokes and their uncertainty, computed on all cores.
#pragma once

#include <vector>

#include "readings/task_readings.h"
#include "readings/uncertainty.h"

namespace condyle::host {

struct StrokeValues {
  SampleRun stroke;
  std::vector<UncertainValue> values;  ///< of readings_of_stroke()
  bool has_onset = false;              ///< a stroke of a task, from its onset on
};

/// The values of read_stroke for each of `strokes` of a task, samples of the path of `analysis` and
/// of the motion of `context`. Each draws noise of its own, whatever other strokes there are.
std::vector<StrokeValues> values_of_strokes(TaskKind kind, const std::vector<SampleRun>& strokes,
                                            const Analysis& analysis, const TaskContext& context);

}  // namespace condyle::host
