// SPDX-License-Identifier: Apache-2.0
// Runs of samples that no jaw can have: bursts that jump away from the path, and frozen poses.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "readings/sample_run.h"

namespace condyle::host {

/// Length that makes a rotation (rad) comparable to a displacement (m).
inline constexpr double kRotationLength_m = 0.1;

/// Bursts in `path`: displacement (m), and rotation times kRotationLength_m. A burst lasts at most
/// 0.2 s. A cubic through four samples before and four after it fits these, and the samples of the
/// burst are far from it: five times the misfit, and 0.3 mm. Good samples between them are none of
/// it. A movement out and back that is as short is none, if its steps show no jump.
std::vector<SampleRun> find_bursts(const std::vector<double>& time_s,
                                   const std::vector<Eigen::Matrix<double, 6, 1>>& path);

/// Runs of five or more equal samples that end with a jump.
std::vector<SampleRun> find_frozen(const std::vector<Eigen::Matrix<double, 6, 1>>& path);

}  // namespace condyle::host
