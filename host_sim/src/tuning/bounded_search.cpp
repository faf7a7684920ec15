// SPDX-License-Identifier: Apache-2.0
#include "tuning/bounded_search.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "statistics/random.h"

namespace condyle::host {
namespace {

// The function that the optimiser calls.
struct Climb {
  const Objective& objective;
  const std::function<bool()>& is_enough;
  nlopt_opt optimiser;
  std::uint64_t evaluations = 0;
  std::exception_ptr failure;  // must not pass through the optimiser

  static double evaluate(unsigned size, const double* at, double*, void* self) {
    Climb& climb = *static_cast<Climb*>(self);
    ++climb.evaluations;
    try {
      const double value = climb.objective(std::vector<double>(at, at + size));
      if (climb.is_enough && climb.is_enough()) nlopt_force_stop(climb.optimiser);
      return std::isfinite(value) ? value : -1e300;
    } catch (...) {
      climb.failure = std::current_exception();
      nlopt_force_stop(climb.optimiser);
      return -1e300;
    }
  }
};

bool are_alike(const SearchOptimum& one, const SearchOptimum& other) {
  if (std::abs(one.value - other.value) > kSameValue) return false;
  for (std::size_t i = 0; i < one.point.size(); ++i) {
    if (std::abs(one.point[i] - other.point[i]) > kSamePoint) return false;
  }
  return true;
}

}  // namespace

SearchOptimum climb(const Objective& objective, const SearchBounds& bounds,
                    std::vector<double> start, std::uint64_t& evaluations,
                    const ClimbSettings& settings) {
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimiser(
      nlopt_create(NLOPT_LN_SBPLX, static_cast<unsigned>(start.size())), nlopt_destroy);
  Climb climb{objective, settings.is_enough, optimiser.get()};
  nlopt_set_lower_bounds(optimiser.get(), bounds.low.data());
  nlopt_set_upper_bounds(optimiser.get(), bounds.high.data());
  nlopt_set_max_objective(optimiser.get(), &Climb::evaluate, &climb);
  nlopt_set_xtol_abs1(optimiser.get(), settings.precision);
  nlopt_set_maxeval(optimiser.get(), settings.most_evaluations);
  std::vector<double> steps;
  for (std::size_t i = 0; i < start.size(); ++i) {
    start[i] = std::clamp(start[i], bounds.low[i], bounds.high[i]);
    const double width = bounds.high[i] - bounds.low[i];
    steps.push_back(width > 0 ? std::min(settings.first_step, 0.25 * width) : 1);
  }
  nlopt_set_initial_step(optimiser.get(), steps.data());
  SearchOptimum found;
  const nlopt_result outcome = nlopt_optimize(optimiser.get(), start.data(), &found.value);
  if (climb.failure) std::rethrow_exception(climb.failure);
  if (outcome == NLOPT_INVALID_ARGS || outcome == NLOPT_OUT_OF_MEMORY || climb.evaluations == 0) {
    throw std::runtime_error("the optimiser failed (" + std::to_string(outcome) + ")");
  }
  found.point = std::move(start);
  evaluations += climb.evaluations;
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
        ClimbSettings settings;
        settings.is_enough = control.stop;
        end.optimum = climb(objective, bounds, result.starts[static_cast<std::size_t>(index)],
                            end.evaluations, settings);
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
  result.stopped = merged < count || (control.stop && control.stop());
  std::stable_sort(
      result.optima.begin(), result.optima.end(),
      [](const SearchOptimum& one, const SearchOptimum& other) { return one.value > other.value; });
  return result;
}

}  // namespace condyle::host
