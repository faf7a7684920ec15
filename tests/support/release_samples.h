// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "condyle/estimator/release/passive_release.h"
#include "support/random.h"

namespace condyle::testing_support {

/// A relaxed jaw let go: by default 10 mm from its rest, seen for 0.6 s at 60 Hz.
struct ReleaseTruth {
  double lambda_per_s = 8, kappa_per_s2 = 400, rest_m = -0.002, opening_m = 0.01;
  double velocity_m_s = 0, duration_s = 0.6, rate_Hz = 60;
};

/// Positions and their times.
struct ReleaseSamples {
  std::vector<double> time_s, position_m;
};

/// The positions of `truth` with white noise of `noise_sd_m`. The solution is compared with
/// mass_spring_damper.h in release_motion_test.cpp.
inline ReleaseSamples release_samples(const ReleaseTruth& truth, double noise_sd_m,
                                      std::uint64_t seed) {
  Random random(seed);
  ReleaseSamples samples;
  const int count = static_cast<int>(truth.duration_s * truth.rate_Hz + 0.5);
  for (int i = 0; i <= count; ++i) {
    const double t = i / truth.rate_Hz;
    const auto at = release_response<double>({truth.lambda_per_s, truth.kappa_per_s2}, t);
    samples.time_s.push_back(t);
    samples.position_m.push_back(truth.rest_m + truth.opening_m * at.C + truth.velocity_m_s * at.S +
                                 noise_sd_m * random.normal());
  }
  return samples;
}

/// Fits them.
inline PassiveRelease<double> fit(const ReleaseSamples& samples, const ReleaseSettings& settings) {
  return fit_passive_release<double>(samples.time_s, samples.position_m, settings);
}

}  // namespace condyle::testing_support
