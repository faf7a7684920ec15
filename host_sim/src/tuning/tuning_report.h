// SPDX-License-Identifier: Apache-2.0
// What tuning by likelihood found, in words and as a picture.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "output/output_file.h"
#include "tuning/likelihood_tuning.h"

namespace condyle::host {

/// Values with their intervals, what was held out, and what does not fit.
std::string tuning_text(const std::vector<TuningRecording>& recordings, const LikelihoodPlan& plan,
                        const LikelihoodTuning& tuning);

/// The head of the parameter file, as comments: what it was tuned to, and how sure that is.
std::string tuning_comment(const std::vector<TuningRecording>& recordings,
                           const LikelihoodPlan& plan, const LikelihoodTuning& tuning);

/// Draws the likelihood's surface and profiles, and correlation and NIS of what was held out, as
/// tuning.svg and tuning.png. `tuning` must have a surface. The files are closed, and wait for
/// `commit`.
std::vector<std::unique_ptr<OutputFile>> draw_tuning(const std::string& directory,
                                                     const std::vector<TuningRecording>& recordings,
                                                     const LikelihoodTuning& tuning);

}  // namespace condyle::host
