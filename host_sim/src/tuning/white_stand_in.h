// SPDX-License-Identifier: Apache-2.0
// The white noise that serves best where noise is not white: the estimators know no other.
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

/// A white model for positions whose noise is that of `model`, `step_s` apart; and what it costs.
struct WhiteStandIn {
  NoiseModel white;
  double velocity_error_m_s = 0;       ///< rms, by `model`
  double best_velocity_error_m_s = 0;  ///< rms of the filter that knows `model`
};
WhiteStandIn white_stand_in(const NoiseModel& model, double step_s);

}  // namespace condyle::host
