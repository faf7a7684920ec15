// SPDX-License-Identifier: Apache-2.0
// How far a motion may be smoothed before it loses what the samples show.
//
//   d    sample minus the motion smoothed with a half window h
//   q    d' C^-1 d / 6 (1 - g), C the noise of a sample, g the share that the smoothed value has of
//        it: 1 on average if the motion is smooth within h
// h contradicts the samples if the mean of q over 0.1 s exceeds 1.5 and six standard deviations of
// the mean of that many samples.
#pragma once

#include "readings/pose_noise.h"

namespace condyle::host {

/// The widest of `widest_s`, and of that divided by powers of sqrt(2), that the samples `begin` to
/// `end` (without) of `motion` do not contradict; at least `least_s`.
double calm_half_width_s(const ReferredMotion& motion, std::size_t begin, std::size_t end,
                         const PoseNoise& noise, double widest_s, double least_s);

}  // namespace condyle::host
