// SPDX-License-Identifier: Apache-2.0
// Whether a stroke is what its task says, and whole.
#pragma once

#include <optional>
#include <string>

#include "readings/reading.h"
#include "readings/reading_geometry.h"
#include "readings/sample_run.h"

namespace condyle::host {

/// Why no reading of the `stroke` in `path` can be trusted; empty: none is known. A stroke must
/// begin and end nearer to the reference position than half of its greatest distance, and with
/// landmarks its turning point must lie in the direction of the task.
std::string problem_of_stroke(TaskKind kind, bool has_landmarks, const JawPath& path,
                              SampleRun stroke);

/// Why readings of the beginning of condylar paths cannot be trusted: the stroke begins more than
/// 1 mm from the reference position, in which the condyles have no travel. Empty: none is known.
std::string problem_of_onset(const JawPath& path, SampleRun stroke);

}  // namespace condyle::host
