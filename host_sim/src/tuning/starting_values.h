// SPDX-License-Identifier: Apache-2.0
// Initial guesses of noise and jerk density from positions alone.
//
// Noise:   sixth differences (sixth_differences.h) of windows of about half a second, in the tenth
//          of the windows with the least motion, which leaves nothing in them.
// Motion:  third differences of positions m samples apart are sums of white noise and white jerk,
//              var = 20 R + 11/20 q (m T)^5
//          (11/20 is the squared norm of the quadratic B-spline); m grows until the motion's part
//          is the larger one.
#pragma once

#include <span>

#include "tuning/innovation_likelihood.h"

namespace condyle::host {

/// The guesses from all of `recordings` together; white noise.
NoiseModel starting_values(std::span<const TuningRecording> recordings);

}  // namespace condyle::host
