// SPDX-License-Identifier: Apache-2.0
// The kinematic centre of a condyle: the point of the jaw whose paths of opening and protrusion
// coincide best (Yatabe, Zwijnenburg, Megens, Naeije 1995, J. Dent. Res. 74:1644).
//
//   E(x, z)   mean distance of the protrusive path, every 0.25 mm from 0.3 mm on, to the path of
//             opening, both on the way out and in the sagittal plane; least within +-12 mm of the
//             condylar point, at its lateral coordinate
// One estimate for each pair of an opening and a protrusion. Value: their mean, less what noise
// drawn anew changes in it. Interval: Student's over the pairs, at least that of the noise, with
// what was subtracted and the error of the condylar point.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "readings/sample_run.h"
#include "readings/uncertainty.h"

namespace condyle::host {

/// The centre of one pair of strokes, forward of the condylar point on `side` (0: left) and above
/// it (m); absent at the border of the search.
std::optional<Eigen::Vector2d> centre_of_pair_m(const JawPath& opened, const JawPath& protruded,
                                                std::size_t side);

/// The centre of the condyle on `side` (0: left): forward of the condylar point and above it (mm),
/// from strokes as samples of `motion`. Missing with fewer than three pairs of strokes in which the
/// condyle travels 6 mm.
std::array<UncertainValue, 2> kinematic_centre(const ReferredMotion& motion, const PoseNoise& noise,
                                               const SharedErrors& errors,
                                               const std::vector<SampleRun>& openings,
                                               const std::vector<SampleRun>& protrusions,
                                               std::size_t side, RandomGenerator& random);

}  // namespace condyle::host
