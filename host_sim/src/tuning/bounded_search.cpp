// SPDX-License-Identifier: Apache-2.0
#include "tuning/bounded_search.h"

#include <algorithm>
#include <cmath>
#include <nlopt.hpp>

#include "simulation/random.h"

namespace condyle::host {
namespace {

constexpr double kPrecision = 1e-4;
constexpr int kMostEvaluations = 2000;

struct Climb {
  const Objective& objective;
  std::uint64_t evaluations = 0;
};

// What the optimiser calls.
double evaluate_climb(const std::vector<double>& point, std::vector<double>&, void* data) {
  Climb& climb = *static_cast<Climb*>(data);
  ++climb.evaluations;
  const double value = climb.objective(point);
  return std::isfinite(value) ? value : -1e300;
}

bool are_alike(const SearchOptimum& one, const SearchOptimum& other) {
  if (std::abs(one.value - other.value) > kSameValue) return false;
  for (std::size_t i = 0; i < one.point.size(); ++i) {
    if (std::abs(one.point[i] - other.point[i]) > kSamePoint) return false;
  }
  return true;
}

}  // namespace

SearchOptimum climb(const Objective& objective, const SearchBounds& bounds,
                    std::vector<double> start, std::uint64_t& evaluations) {
  nlopt::opt optimiser(nlopt::LN_SBPLX, static_cast<unsigned>(start.size()));
  optimiser.set_lower_bounds(bounds.low);
  optimiser.set_upper_bounds(bounds.high);
  Climb data{objective};
  optimiser.set_max_objective(evaluate_climb, &data);
  optimiser.set_xtol_abs(kPrecision);
  optimiser.set_maxeval(kMostEvaluations);
  std::vector<double> steps;
  for (std::size_t i = 0; i < start.size(); ++i) {
    start[i] = std::clamp(start[i], bounds.low[i], bounds.high[i]);
    steps.push_back(std::min(1.0, 0.25 * (bounds.high[i] - bounds.low[i])));
  }
  optimiser.set_initial_step(steps);
  SearchOptimum found;
  try {
    optimiser.optimize(start, found.value);
  } catch (const nlopt::roundoff_limited&) {
    found.value = objective(start);  // as far as the numbers allow
  }
  found.point = std::move(start);
  evaluations += data.evaluations;
  return found;
}

std::vector<std::vector<double>> draw_starts(const std::vector<double>& first, double spread,
                                             const SearchBounds& bounds, std::size_t count,
                                             std::uint64_t seed) {
  std::vector<std::vector<double>> starts;
  RandomGenerator random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double> start = first;
    for (std::size_t j = 0; j < start.size(); ++j) {
      if (i > 0) start[j] += spread * (2 * random.uniform() - 1);
      start[j] = std::clamp(start[j], bounds.low[j], bounds.high[j]);
    }
    starts.push_back(std::move(start));
  }
  return starts;
}

SearchResult search(const Objective& objective, const SearchBounds& bounds,
                    std::vector<std::vector<double>> starts, const MonteCarloProgress& progress,
                    const MonteCarloControl& control) {
  struct End {
    SearchOptimum optimum;
    std::uint64_t evaluations = 0;
  };
  SearchResult result;
  result.starts = std::move(starts);
  const std::uint64_t count = result.starts.size();
  const std::uint64_t merged = run_monte_carlo(
      count, 0,
      [&](std::uint64_t index) {
        End end;
        end.optimum = climb(objective, bounds, result.starts[static_cast<std::size_t>(index)],
                            end.evaluations);
        return end;
      },
      [&](End&& end) {
        result.evaluations += end.evaluations;
        for (SearchOptimum& known : result.optima) {
          if (!are_alike(known, end.optimum)) continue;
          if (end.optimum.value > known.value) {
            known.point = end.optimum.point;
            known.value = end.optimum.value;
          }
          ++known.reached_by;
          return;
        }
        result.optima.push_back(std::move(end.optimum));
      },
      progress, control);
  result.stopped = merged < count;
  std::stable_sort(
      result.optima.begin(), result.optima.end(),
      [](const SearchOptimum& one, const SearchOptimum& other) { return one.value > other.value; });
  return result;
}

}  // namespace condyle::host
