// SPDX-License-Identifier: Apache-2.0
// What a recording says of itself along one axis, looked at as a whole: which samples are regular,
// how noisy they are, and the velocity, by a smoothing spline that no filter shares.
//
//   e    a sample less the cubic through the two before and the two after it
//   s    its local scale: 1.4826 times the median of |e| over 51 samples, at least that of rounding
//   irregular   |e| > 8 s: a glitch, a step, an impact too fast for the rate
//   valid       |e| <= 4 s, and no irregular sample within 2
// The spline minimises sum (y - x)^2 + lambda sum (third difference of x)^2 over each stretch of 30
// regular samples or more; lambda by generalised cross-validation (P. Craven, G. Wahba, Numer.
// Math. 31 (1979) 377). The standard deviation of its velocity is that of the noise and half of
// what lambda times and divided by 8 change. Four samples at each end are left out.
#pragma once

#include <vector>

#include "real_motion/recordings.h"

namespace condyle::testing_support {

/// One axis of a recording. NaN where nothing is known.
struct ReferenceMotion {
  bool is_scored = false;  ///< it moves enough, and long enough in one piece
  double noise_m = 0;
  std::vector<bool> is_irregular, is_valid;
  std::vector<double> velocity_m_s, velocity_sd_m_s;
};

/// Looks at axis `axis` of `recording`.
ReferenceMotion reference_motion(const RealRecording& recording, std::size_t axis);

}  // namespace condyle::testing_support
