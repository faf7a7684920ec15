// SPDX-License-Identifier: Apache-2.0
#include "output/live_estimates.h"

namespace condyle::host {

template class LiveFile<EstimatesFile>;
template class LiveFile<PoseFile>;
template class LiveFile<CyclesFile>;

}  // namespace condyle::host
