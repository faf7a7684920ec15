// SPDX-License-Identifier: Apache-2.0
// The best white approximation of noise that is not white, because the estimators assume white
// noise.
//
// A filter for white noise of variance R and jerk of density q, run on positions whose noise is
// Gauss-Markov (innovation_likelihood.h), errs by
//   e' = (I - K h)(F e + w) - K n,   n' = phi n + ...
// with its gain K, which depends on q/R alone. The covariance of (e, n) settles; q/R is chosen so
// that the velocity's error is smallest, then R so that none of the stated variances of position,
// velocity and acceleration is below the error's.
#pragma once

#include "tuning/innovation_likelihood.h"

namespace condyle::host {

/// A white model for positions with the noise of `model`, `step_s` apart; and its cost in accuracy.
struct EquivalentWhiteNoise {
  NoiseModel white;
  double velocity_error_m_s = 0;       ///< rms, by `model`
  double best_velocity_error_m_s = 0;  ///< rms of the filter with the true `model`
};
EquivalentWhiteNoise equivalent_white_noise(const NoiseModel& model, double step_s);

}  // namespace condyle::host
