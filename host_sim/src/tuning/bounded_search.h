// SPDX-License-Identifier: Apache-2.0
// The largest value of a function of a few numbers within bounds, from many starts.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "statistics/monte_carlo.h"

namespace condyle::host {

/// A function to be made as large as possible. Called from several threads.
using Objective = std::function<double(const std::vector<double>&)>;

/// Lowest and highest of each number.
struct SearchBounds {
  std::vector<double> low, high;
};

/// A point where the function is largest near by.
struct SearchOptimum {
  std::vector<double> point;
  double value = 0;
  int reached_by = 1;  ///< starts that ended here
};

/// What the search found.
struct SearchResult {
  std::vector<SearchOptimum> optima;        ///< best first, no two alike
  std::vector<std::vector<double>> starts;  ///< where it began
  std::uint64_t evaluations = 0;
  bool stopped = false;
};

/// Two ends of the search are one optimum where their values differ by less than kSameValue and no
/// coordinate of them by more than kSamePoint.
inline constexpr double kSameValue = 0.01, kSamePoint = 0.02;

/// How far a search goes.
struct ClimbSettings {
  double first_step = 1;    ///< in each coordinate
  double precision = 1e-4;  ///< it ends where it moves less, in each coordinate
  int most_evaluations = 2000;
  std::function<bool()> is_enough;  ///< asked after each evaluation; may be empty
};

/// The largest of `objective` near `start`, by Subplex (T. Rowan 1990) as NLopt implements it
/// (S. G. Johnson, The NLopt nonlinear-optimization package). A value that is not finite counts as
/// very small. `evaluations` grows by those made.
SearchOptimum climb(const Objective& objective, const SearchBounds& bounds,
                    std::vector<double> start, std::uint64_t& evaluations,
                    const ClimbSettings& settings = {});

/// `first` and `count` - 1 further starts, drawn evenly within `spread` of it along each coordinate
/// and within the bounds; by `seed`, the same for every number of threads.
std::vector<std::vector<double>> draw_starts(const std::vector<double>& first, double spread,
                                             const SearchBounds& bounds, std::size_t count,
                                             std::uint64_t seed);

/// Climbs from each of `starts`, on all cores. `progress` as for run_monte_carlo; `control.stop` is
/// asked by all threads, also on the way.
SearchResult search(const Objective& objective, const SearchBounds& bounds,
                    std::vector<std::vector<double>> starts, const MonteCarloProgress& progress,
                    const MonteCarloControl& control);

}  // namespace condyle::host
