// SPDX-License-Identifier: Apache-2.0
// The likelihood of positions, given noise and jerk density, from a filter's innovations.
//
//   z, p, v, a   measured position; position, velocity, acceleration (m, m/s, m/s^2)
//   n            noise of the position (m), sigma its standard deviation
//   tau          its correlation time (s); 0: white
//   q            spectral density of the jerk (m^2/s^5)
//   T            time step (s)
//   nu, S        innovation (m) and its variance (m^2)
//
// Model:       (p, v, a) as in white_jerk.h;  z = p + n
//              n' = phi n + w,  phi = e^(-T/tau),  w ~ N(0, (1 - phi^2) sigma^2)
//              With tau = 0, phi = 0 and the model is that of the recommended estimator without
//              adaptation, R = sigma^2; with tau > 0 the noise is a Gauss-Markov process (A. Gelb,
//              Applied Optimal Estimation (1974), section 3.7): what a low pass leaves of it.
// Likelihood:  log l = -1/2 sum(log(2 pi S) + rho(nu^2 / S)), F. C. Schweppe, IEEE Trans. Inf.
//              Theory 11 (1965) 61-70, with Huber's rho(d^2) = d^2 up to |d| = k, then
//              2 k |d| - k^2: a glitch does not become noise. Of Gaussian innovations 0.27 % are
//              beyond k = 3.
//
// The first kSettling innovations of a stretch depend on the prior and are left out.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "tuning/tuning_recording.h"

namespace condyle::host {

/// The tuned parameters.
struct NoiseModel {
  double position_sd_m = 0;       ///< sigma
  double jerk_density_m2_s5 = 0;  ///< q
  double correlation_time_s = 0;  ///< tau
};

/// One innovation.
struct Innovation {
  double innovation_m = 0, variance_m2 = 0;  ///< nu, S
  double standardised() const { return innovation_m / std::sqrt(variance_m2); }
  /// Its share of log l.
  double score() const {
    constexpr double kHuber = 3;
    const double d = std::abs(standardised());
    const double loss = d <= kHuber ? d * d : 2 * kHuber * d - kHuber * kHuber;
    return -0.5 * (std::log(2 * std::numbers::pi * variance_m2) + loss);
  }
};

/// The filter of the model above.
class NoiseFilter {
 public:
  static constexpr int kSettling = 20;

  NoiseFilter(const NoiseModel& model, const MotionPriorParameters& prior)
      : model_(model), prior_(prior) {}

  /// Starts with the measured position `z_m`.
  void start(double z_m);
  /// Advances by `step_s`.
  void predict(double step_s);
  /// Corrects with the position `z_m`.
  Innovation update(double z_m);
  /// Covariance of (p, v, a, n).
  const Eigen::Matrix4d& covariance() const { return P_; }

 private:
  using State = Eigen::Vector4d;  // p, v, a, n
  NoiseModel model_;
  MotionPriorParameters prior_;
  State x_;
  Eigen::Matrix4d P_;
};

/// Calls `sink(index, innovation)` for each counted innovation of `samples`; `index`: that of its
/// sample.
template <class Sink>
void for_each_innovation(std::span<const TuningSample> samples, const NoiseModel& model,
                         const MotionPriorParameters& prior, Sink&& sink) {
  NoiseFilter filter(model, prior);
  bool started = false;
  int settling = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const TuningSample& sample = samples[i];
    const bool is_measured = std::isfinite(sample.position_m);
    started = started && sample.step_s > 0;
    if (!started) {
      if (!is_measured) continue;
      filter.start(sample.position_m);
      started = true;
      settling = NoiseFilter::kSettling;
      continue;
    }
    filter.predict(sample.step_s);
    if (!is_measured) continue;
    const Innovation innovation = filter.update(sample.position_m);
    if (settling > 0) {
      --settling;
    } else {
      sink(i, innovation);
    }
  }
}

}  // namespace condyle::host
