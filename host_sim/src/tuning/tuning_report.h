// SPDX-License-Identifier: Apache-2.0
// The result of tuning by likelihood, as text and figure.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "condyle/estimator/sensors/learned_sensor.h"
#include "output/output_file.h"
#include "tuning/likelihood_tuning.h"

namespace condyle::host {

/// Values with their intervals, the held-out part, and deviations from the model.
std::string tuning_text(const std::vector<TuningRecording>& recordings, const LikelihoodPlan& plan,
                        const LikelihoodTuning& tuning);

/// What learning gains with the tuned values; empty if nothing was counted.
std::string learning_text(const LearningCounts& counts);

/// The head of the parameter file, as comments: recordings and certainty of the tuning.
std::string tuning_comment(const std::vector<TuningRecording>& recordings,
                           const LikelihoodPlan& plan, const LikelihoodTuning& tuning);

/// Draws the likelihood's surface and profiles, and correlation and NIS of the held-out part, as
/// tuning.svg and tuning.png. `tuning` must have a surface. The files are closed but not committed.
std::vector<std::unique_ptr<OutputFile>> draw_tuning(const std::string& directory,
                                                     const std::vector<TuningRecording>& recordings,
                                                     const LikelihoodTuning& tuning);

}  // namespace condyle::host
