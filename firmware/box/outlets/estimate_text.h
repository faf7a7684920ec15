// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "box/realtime/box_estimate.h"
#include "hosted/estimates/followed_cycles.h"
#include "hosted/estimates/pose_choice.h"

namespace condyle::box {

/// An estimate as one line of JSON, without the line's end. Numbers read back to the same bits;
/// unknown values are null. Every value has its standard deviation and its provenance. A
/// microcontroller's estimate includes its delay; if the microcontroller is away, a line states
/// that. `pose`: what is shown of a whole pose, if the estimate has one. `cycle`: that has ended
/// with the estimate.
std::string estimate_line(const BoxEstimate& estimate, const host::PoseChoice& pose = {},
                          const std::optional<host::FoundCycle>& cycle = {});

}  // namespace condyle::box
