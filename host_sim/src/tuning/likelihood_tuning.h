// SPDX-License-Identifier: Apache-2.0
// Noise and jerk density that make recordings most likely (innovation_likelihood.h): for white
// noise, and if the noise is not white for Gauss-Markov noise.
//
// Searched are ln sigma^2, ln q and, not white, ln tau. Uncertainty of the logarithms: the larger
// of H^-1 and H^-1 J H^-1 (H: curvature of -log l; J: scatter of its slopes from stretch to
// stretch), P. J. Huber, Proc. 5th Berkeley Symp. 1 (1967) 221-233, because jaw motion is not
// exactly white jerk.
#pragma once

#include <optional>
#include <vector>

#include "tuning/bounded_search.h"
#include "tuning/cross_validation.h"
#include "tuning/equivalent_white_noise.h"

namespace condyle::host {

/// Options of tuning.
struct LikelihoodPlan {
  Range position_sd_m{1e-7, 1e-2};  ///< bounds
  Range jerk_density_m2_s5{1e-6, 1e6};
  std::optional<NoiseModel> start;  ///< otherwise from the data; clamped to the bounds
  std::size_t starts = 12;  ///< this one, and others wrong by a factor of up to kStartFactor
  std::uint64_t seed = 1;
  bool with_surface = false;  ///< compute profiles and surface
  MotionPriorParameters prior;
};

/// Largest factor between other starts and the first.
inline constexpr double kStartFactor = 1000;

/// Largest log likelihood with one parameter held, relative to the optimum.
struct ProfilePoint {
  double value = 0;  ///< of the parameter, in its unit
  double log_likelihood = 0;
};

/// A fitted parameter.
struct FittedParameter {
  double value = 0;   ///< sigma (m), q (m^2/s^5) or tau (s)
  double log_sd = 0;  ///< standard deviation of its natural logarithm; infinite: not known
  bool at_bound = false;
  /// True if, within the bounds, log l falls to the 95 % level on both sides.
  bool is_bounded = false;
  std::vector<ProfilePoint> profile;
};

/// A fitted model.
struct FittedModel {
  NoiseModel values;
  std::vector<FittedParameter> parameters;  ///< sigma, q and, not white, tau
  double log_likelihood = 0;                ///< of the fitted stretches
  SearchResult search;
  /// More than half of the starts came to the best, or no other is within 2 of it.
  bool is_unique = false;
  CrossValidation held_out;
};

/// log l over sigma and q, white noise, relative to the optimum: one row for each q.
struct LikelihoodSurface {
  std::vector<double> position_sd_m, jerk_density_m2_s5;
  std::vector<double> log_likelihood;
};

/// The result of tuning.
struct LikelihoodTuning {
  NoiseModel start;
  FittedModel white;
  std::optional<FittedModel> correlated;         ///< if a recording's noise is not white
  bool correlated_serves = false;                ///< it explains the held-out part better
  std::optional<EquivalentWhiteNoise> stand_in;  ///< then
  NoiseModel written;                            ///< white noise for the estimator
  CrossValidation written_check;                 ///< of that
  std::vector<std::string> reasons;              ///< why white noise does not explain it
  std::optional<LikelihoodSurface> surface;
  bool stopped = false;
};

/// Tunes to `recordings`, of which there is at least one. Throws InputError if gaps leave nothing
/// to fit or to hold out. Calls `show(share)` during the work; all threads call `control.stop`.
LikelihoodTuning tune_by_likelihood(const std::vector<TuningRecording>& recordings,
                                    const LikelihoodPlan& plan,
                                    const std::function<void(double)>& show,
                                    const MonteCarloControl& control);

}  // namespace condyle::host
