// SPDX-License-Identifier: Apache-2.0
// The paper's way of tuning the published cascade: Q and R are changed until stage 3 returns the
// assumed mass and friction stays steady (matching_criterion.h defines this, and J). That leaves
// friction open: the search finds many tunings that satisfy the criterion, and the spread of their
// frictions.
//
// The variances of kFreeVariances are free. Four are enough: multiplying all variances of a stage
// by one number does not change its estimates, so its measurement variances may stay fixed. With
// four more free (three measurement variances, the mass's initial variance) friction spreads
// further: on 30 s of simulated chewing from 0.001 to 0.58 Ns/m instead of from 0.01 to 0.27.
//
// Each start draws the four log-uniformly between their bounds; SBPLX of NLopt (a simplex search in
// subspaces, without derivatives) lowers J from there over their decimal logarithms, and ends as
// soon as the criterion, a threshold, is satisfied. If the search continued to the smallest J,
// nearly all starts would end with friction frozen at its initial value.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "condyle/estimator/published/parameters.h"
#include "statistics/monte_carlo.h"
#include "tuning/matching_criterion.h"

namespace condyle::host {

/// A variance that the search changes.
struct FreeVariance {
  const char* column;  ///< name in a table, with its unit
  const char* symbol;  ///< short name, without unit
  const char* words;   ///< description
  double& (*of)(PublishedParameters&);
  Range factors;  ///< default bounds, as factors of the value in the base
};

/// The free ones, in the order of PublishedTuningPlan::factors. One that is 0 in the base stays 0.
inline constexpr FreeVariance kFreeVariances[] = {
    {"motion_process_variance_force_N2",
     "Q_F",
     "process variance of the net force (N^2)",
     [](PublishedParameters& p) -> double& { return p.motion.process_variance[2]; },
     {1e-3, 1e3}},
    // From a prior that fixes friction to one without information: sd 1e-5 to 1 Ns/m by default.
    {"friction_initial_variance_N2s2_m2",
     "P_kv",
     "initial variance of friction (N^2 s^2/m^2)",
     [](PublishedParameters& p) -> double& { return p.friction.initial_variance[2]; },
     {1e-2, 1e8}},
    {"friction_process_variance_N2s2_m2",
     "Q_kv",
     "process variance of friction (N^2 s^2/m^2)",
     [](PublishedParameters& p) -> double& { return p.friction.process_variance[2]; },
     {1e-3, 1e3}},
    {"mass_process_variance_kg2",
     "Q_m",
     "process variance of the mass (kg^2)",
     [](PublishedParameters& p) -> double& { return p.mass.process_variance[2]; },
     {1e-3, 1e3}},
};
inline constexpr std::size_t kFreeVarianceCount = std::size(kFreeVariances);

/// Two tunings are distinct if their ratio in a free variance is at least this.
inline constexpr double kDistinctFactor = 2;

/// Options of the search.
struct PublishedTuningPlan {
  std::uint64_t starts = 100;
  std::uint64_t seed = 1;
  /// Bounds of the free variances, times their values in the base; above 0, ends may be equal.
  std::array<Range, kFreeVarianceCount> factors = [] {
    std::array<Range, kFreeVarianceCount> bounds{};
    for (std::size_t i = 0; i < kFreeVarianceCount; ++i) bounds[i] = kFreeVariances[i].factors;
    return bounds;
  }();
  int most_evaluations = 300;  ///< for each start, before it is abandoned
  double steady_share = 0.05;  ///< largest range of friction, as a share of its mean
};

/// The result of the search. Frictions are `PublishedTuning::friction_Ns_m`.
struct PublishedTuningResult {
  PublishedParameters base;
  PublishedTuningPlan plan;
  std::vector<std::string> recordings;     ///< names
  std::uint64_t starts = 0;                ///< completed: the plan's, or fewer if it was stopped
  std::uint64_t satisfied = 0;             ///< starts that satisfied the criterion
  std::uint64_t satisfied_at_once = 0;     ///< of these, without any search
  std::uint64_t evaluations = 0;           ///< of the objective, by all starts
  std::vector<PublishedTuning> tunings;    ///< distinct ones that satisfy it, smallest J first
  std::optional<PublishedTuning> closest;  ///< smallest J, if none satisfies it
  double lowest_friction_Ns_m = 0, highest_friction_Ns_m = 0;  ///< of `tunings`
  std::uint64_t at_initial_friction = 0;  ///< of `tunings`: within `steady_share` of initial_Ns_m
  /// Highest over lowest friction; 1 if there is none.
  double friction_ratio() const {
    return tunings.empty() ? 1 : highest_friction_Ns_m / lowest_friction_Ns_m;
  }
};

/// Searches for tunings around `base`, which must satisfy `is_valid`. The result is the same for
/// every number of threads. All threads call `control.stop`, also during a search. InputError if
/// there is no recording, one is too short or its position never changes (stage 3 could not
/// estimate the mass), its sample time is out of range, or the plan has a number out of range.
PublishedTuningResult tune_by_published_criterion(std::span<const PublishedRecording> recordings,
                                                  const PublishedParameters& base,
                                                  const PublishedTuningPlan& plan,
                                                  const MonteCarloProgress& progress = {},
                                                  const MonteCarloControl& control = {});

}  // namespace condyle::host
