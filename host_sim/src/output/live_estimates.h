// SPDX-License-Identifier: Apache-2.0
// Writes estimates live, without blocking the estimator.
#pragma once

#include "output/cycles_file.h"
#include "output/estimates_file.h"
#include "output/live_file.h"
#include "output/pose_file.h"

namespace condyle::host {

extern template class LiveFile<EstimatesFile>;
extern template class LiveFile<PoseFile>;
extern template class LiveFile<CyclesFile>;

using LiveEstimates = LiveFile<EstimatesFile>;
using LivePoses = LiveFile<PoseFile>;
using LiveCycles = LiveFile<CyclesFile>;

}  // namespace condyle::host
