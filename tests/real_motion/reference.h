// SPDX-License-Identifier: Apache-2.0
// What a recording says of itself along one axis, looked at as a whole: which samples are regular,
// how noisy they are, and the velocity, by a smoothing spline that no filter shares.
//
//   e    a sample less the cubic through the two before and the two after it
//   s    its local scale: 1.4826 times the median of |e| over 51 samples, at least a quarter of
//   that
//        of the recording and 0.6 steps of rounding
//   irregular   |e| > 8 s: a glitch, a step, an impact too fast for the rate
//   valid       |e| <= 4 s, and no irregular sample within 2
// The velocity is known in each stretch of 30 samples or more without a gap and without an
// irregular sample within 2, but for four samples at each end.
#pragma once

#include <vector>

#include "real_motion/recordings.h"

namespace condyle::testing_support {

/// One axis of a recording. NaN where nothing is known.
struct ReferenceMotion {
  bool is_known = false;   ///< it moves, and its velocity is known somewhere
  bool is_scored = false;  ///< known, and it moves by 8 standard deviations of the noise
  double noise_m = 0;
  Values position_m;   ///< as measured, without what faults changed
  Marks is_irregular;  ///< no runaway is sought there
  Marks is_valid;      ///< to refuse it is wrong
  Marks is_measured;   ///< along all axes
  Values velocity_m_s, velocity_sd_m_s;
};

/// True within `reach` samples of a marked one.
Marks to_double(const Marks& marks, std::size_t reach);

/// Looks at axis `axis` of `treated`.
ReferenceMotion reference_motion(const TreatedRecording& treated, std::size_t axis);

}  // namespace condyle::testing_support
