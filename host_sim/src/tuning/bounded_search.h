// SPDX-License-Identifier: Apache-2.0
// Maximises a function of a few numbers within bounds, from many starts.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "statistics/monte_carlo.h"

namespace condyle::host {

/// The function to maximise. Called from several threads.
using Objective = std::function<double(const std::vector<double>&)>;

/// Bounds of each number.
struct SearchBounds {
  std::vector<double> low, high;
};

/// A local maximum.
struct SearchOptimum {
  std::vector<double> point;
  double value = 0;
  int reached_by = 1;  ///< number of starts that ended here
};

/// The result of the search.
struct SearchResult {
  std::vector<SearchOptimum> optima;        ///< best first, all distinct
  std::vector<std::vector<double>> starts;  ///< starting points
  std::uint64_t evaluations = 0;
  bool stopped = false;
};

/// Two end points count as one optimum if their values differ by less than kSameValue and each
/// coordinate by at most kSamePoint.
inline constexpr double kSameValue = 0.01, kSamePoint = 0.02;

/// Limits of a search.
struct ClimbSettings {
  double first_step = 1;    ///< in each coordinate
  double precision = 1e-4;  ///< it ends when it moves less, in each coordinate
  int most_evaluations = 2000;
  std::function<bool()> is_enough;  ///< called after each evaluation; may be empty
};

/// The largest of `objective` near `start`, by Subplex (T. Rowan 1990) as NLopt implements it
/// (S. G. Johnson, The NLopt nonlinear-optimization package). A value that is not finite counts as
/// very small. Adds the number of evaluations to `evaluations`.
SearchOptimum climb(const Objective& objective, const SearchBounds& bounds,
                    std::vector<double> start, std::uint64_t& evaluations,
                    const ClimbSettings& settings = {});

/// `first` and `count` - 1 further starts, drawn uniformly within `spread` of it along each
/// coordinate and within the bounds. They depend only on `seed`.
std::vector<std::vector<double>> draw_starts(const std::vector<double>& first, double spread,
                                             const SearchBounds& bounds, std::size_t count,
                                             std::uint64_t seed);

/// Climbs from each of `starts`, on all cores. `progress` as for run_monte_carlo. All threads call
/// `control.stop`, also during a search.
SearchResult search(const Objective& objective, const SearchBounds& bounds,
                    std::vector<std::vector<double>> starts, const MonteCarloProgress& progress,
                    const MonteCarloControl& control);

}  // namespace condyle::host
