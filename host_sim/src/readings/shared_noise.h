// SPDX-License-Identifier: Apache-2.0
// Noise that neighbouring samples share: of an instrument that smooths, drifts or hums, or of a jaw
// that is not quite still. From a rest.
//
//   e    at a sample, for each component: sqrt(a_0) g_0 + sum_j sqrt(a_j) g_j, j > 0
//   g_0  white; g_j of the correlation exp(-(lag / tau_j)^2 / 2), tau_j = 1, 2, 4, ... samples; all
//        of unit variance
//   V(L) mean of (x_k - 2 x_(k+L) + x_(k+2L))^2 / 6 at rest. Of white noise it is a_0; g_j gives
//        a_j (1 - (4 rho_j(L) - rho_j(2 L)) / 3). L = 1, 2, 4, ..., up to a sixth of the rest
//   hum  each line of the spectrum (hum.h) is subtracted before, and is a part of its own:
//        C (n_1 cos w t - n_2 sin w t) + S (n_2 cos w t + n_1 sin w t), C and S its cosine and sine
//        over sqrt(2), n of the correlation exp(-(lag / T)^2 / 2), T the time of the rest
//   a    at least 0, least squares of V(L) relative to its size. Before, V(L) of few independent
//        differences is raised by Student's factor squared over the normal one, and to that of
//        shorter lags
// What is slower than the rest does not show here; other rests of the recording do (analysis.cpp).
#pragma once

#include <boost/random/normal_distribution.hpp>
#include <vector>

#include "readings/pose_track.h"
#include "statistics/random.h"

namespace condyle::host {

/// Noise with the correlation exp(-(lag / tau_s)^2 / 2) cos(2 pi frequency_Hz lag).
struct SharedNoise {
  double tau_s = 0;
  Matrix6 root = Matrix6::Zero();  ///< root root' = covariance; of a hum, C and S
  double frequency_Hz = 0;         ///< of a hum; else 0

  double correlation(double lag_s) const;
};

/// Variances of the parts of one component.
struct NoiseParts {
  double white = 0;
  std::vector<double> shared;  ///< of tau = 1, 2, 4, ... samples
};

/// The longest lag L (samples) that a rest of `count` samples shows.
inline std::size_t longest_lag(std::size_t count) {
  return count / 6;
}

/// V(L) of component `i` of the samples `begin` to `end` (without) of `motion`, as measured.
double variance_over(const ReferredMotion& motion, std::size_t begin, std::size_t end,
                     std::size_t lag, int i);

/// The parts of component `i` at a rest from `begin` to `end`; `white_least`: variance that sixth
/// differences show elsewhere in the recording.
NoiseParts noise_parts(const ReferredMotion& motion, std::size_t begin, std::size_t end, int i,
                       double white_least);

/// Adds a draw of `noise` to the `errors` at `time_s`.
void add_shared_noise(const std::vector<SharedNoise>& noise, const std::vector<double>& time_s,
                      RandomGenerator& random, std::vector<Vector6>& errors);

}  // namespace condyle::host
