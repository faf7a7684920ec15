// SPDX-License-Identifier: Apache-2.0
// Recordings of a jaw point that chews under a measured force.
#pragma once

#include <vector>

#include "consistency/driven_chewing.h"

namespace condyle::testing_support {

inline constexpr double kPositionSd_m = DrivenChewing::kPositionSd_m;
inline constexpr double kDriveSd_N = DrivenChewing::kDriveSd_N;

std::vector<DrivenSample> chew(const DrivenTruth& truth, double rate_Hz, unsigned seed,
                               double duration_s = 30);

}  // namespace condyle::testing_support
