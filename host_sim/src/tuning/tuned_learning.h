// SPDX-License-Identifier: Apache-2.0
// What learning (motion_corrector.h) gains on recordings with tuned parameters.
#pragma once

#include <vector>

#include "condyle/estimator/sensors/learned_sensor.h"
#include "tuning/tuning_recording.h"

namespace condyle::host {

/// Of all `recordings` together, each from its own beginning; all 0 if `parameters` turn learning
/// off.
LearningCounts learning_with(const RecommendedParameters& parameters,
                             const std::vector<TuningRecording>& recordings);

}  // namespace condyle::host
