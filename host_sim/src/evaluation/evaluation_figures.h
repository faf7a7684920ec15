// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "evaluation/estimator_evaluation.h"
#include "output/output_file.h"

namespace condyle::host {

/// Draws an evaluation into `directory`, which must exist, as SVG and PNG: velocity_error, the rms
/// of error and claimed standard deviation over time; and, if the estimator computes them and their
/// truth varies, friction_response and mass_response, estimate against truth. `title` names
/// scenario and estimator. The files are closed but not committed. Problems are InputErrors.
std::vector<std::unique_ptr<OutputFile>> draw_evaluation(const std::string& directory,
                                                         const std::string& title,
                                                         const Evaluation& evaluation);

}  // namespace condyle::host
