// SPDX-License-Identifier: Apache-2.0
#include "tuning/published_criterion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hosted/files/input_error.h"
#include "statistics/random.h"
#include "tuning/bounded_search.h"

namespace condyle::host {
namespace {

constexpr std::size_t kFewestPositions = 40;  // ten for the judgement
constexpr double kFirstStep = 0.5;            // decades
constexpr double kSmallestStep = 0.01;        // decades: the search ends when it moves less

using Exponents = std::vector<double>;  // decimal, of the factors

PublishedParameters with_factors(const PublishedParameters& base, const Exponents& exponents) {
  PublishedParameters parameters = base;
  for (std::size_t i = 0; i < kFreeVarianceCount; ++i) {
    double& variance = kFreeVariances[i].of(parameters);
    variance = std::min(variance * std::pow(10, exponents[i]), kVarianceRange.highest);
  }
  return parameters;
}

bool are_distinct(PublishedParameters a, PublishedParameters b) {
  return std::any_of(std::begin(kFreeVariances), std::end(kFreeVariances),
                     [&](const FreeVariance& free) {
                       const auto [low, high] = std::minmax({free.of(a), free.of(b)});
                       return high > 0 && high >= kDistinctFactor * low;
                     });
}

void refuse_plan(const PublishedTuningPlan& plan) {
  const auto refuse = [](const char* what, const char* mend) {
    throw InputError("published criterion", what, mend);
  };
  if (plan.starts == 0) refuse("the number of starts is 0", "give at least 1");
  if (plan.most_evaluations < 1) {
    refuse("the number of evaluations per start is 0", "give at least 1");
  }
  if (!(plan.steady_share > 0) || !std::isfinite(plan.steady_share)) {
    refuse("the share within which friction counts as steady is not above 0",
           "give a share such as 0.05");
  }
  for (std::size_t i = 0; i < kFreeVarianceCount; ++i) {
    const Range& range = plan.factors[i];
    if (range.lowest > 0 && range.lowest <= range.highest && std::isfinite(range.highest)) continue;
    throw InputError("published criterion",
                     fmt::format("the bounds {:g} to {:g} of {} are not factors from low to high",
                                 range.lowest, range.highest, kFreeVariances[i].words),
                     "give two numbers above 0, the smaller one first");
  }
}

void refuse_recordings(std::span<const PublishedRecording> recordings,
                       const PublishedParameters& base) {
  if (recordings.empty()) {
    throw InputError("published criterion", "there is no recording", "give one");
  }
  for (const auto& recording : recordings) {
    PublishedParameters parameters = base;
    parameters.sample_time_s = recording.sample_time_s;
    if (!is_valid(parameters)) {
      throw InputError(
          recording.name,
          fmt::format("its sample time of {:g} s is out of range", recording.sample_time_s),
          "it must be from 1e-6 to 10 s");
    }
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    std::size_t measured = 0;
    for (const double z : recording.position_m) {
      if (!std::isfinite(z)) continue;
      ++measured;
      lowest = std::min(lowest, z);
      highest = std::max(highest, z);
    }
    if (measured < kFewestPositions) {
      throw InputError(recording.name,
                       fmt::format("has {} measured positions, too few for tuning", measured),
                       fmt::format("record at least {}", kFewestPositions));
    }
    if (!(highest > lowest)) {
      throw InputError(
          recording.name,
          "its position never changes: without motion the third filter cannot estimate a mass",
          "give a recording in which the jaw moves");
    }
  }
}

// The result of a start.
struct SearchedStart {
  PublishedTuning best;  // the first that satisfies the criterion, or the smallest J
  std::uint64_t evaluations = 0;
};

class PublishedSearch {
 public:
  PublishedSearch(std::span<const PublishedRecording> recordings, const PublishedParameters& base,
                  const PublishedTuningPlan& plan, const std::function<bool()>& stop)
      : recordings_(recordings), base_(base), plan_(plan), stop_(stop) {}

  SearchedStart run(std::uint64_t start) {
    RandomGenerator random(plan_.seed, start);
    Exponents lowest(kFreeVarianceCount), highest(kFreeVarianceCount),
        exponents(kFreeVarianceCount);
    for (std::size_t i = 0; i < kFreeVarianceCount; ++i) {
      lowest[i] = std::log10(plan_.factors[i].lowest);
      highest[i] = std::log10(plan_.factors[i].highest);
      const double drawn = lowest[i] + (highest[i] - lowest[i]) * random.uniform();
      exponents[i] = std::clamp(drawn, lowest[i], highest[i]);
    }
    ClimbSettings settings;
    settings.first_step = kFirstStep;
    settings.precision = kSmallestStep;
    settings.most_evaluations = plan_.most_evaluations;
    settings.is_enough = [this] { return best_->satisfies || (stop_ && stop_()); };
    SearchedStart searched;
    (void)climb([this](const std::vector<double>& x) { return -evaluate(x); }, {lowest, highest},
                exponents, searched.evaluations, settings);
    searched.best = std::move(*best_);
    return searched;
  }

 private:
  double evaluate(const Exponents& exponents) {
    PublishedTuning tuning =
        judge_published_tuning(recordings_, with_factors(base_, exponents), plan_.steady_share);
    const double value = tuning.objective;
    if (!best_ || tuning.satisfies || value < best_->objective) best_ = std::move(tuning);
    return value;
  }

  std::span<const PublishedRecording> recordings_;
  const PublishedParameters& base_;
  const PublishedTuningPlan& plan_;
  const std::function<bool()>& stop_;
  std::optional<PublishedTuning> best_;
};

// `tunings`, best first, without those not distinct from a better one.
std::vector<PublishedTuning> distinct_tunings(std::vector<PublishedTuning> tunings) {
  std::stable_sort(tunings.begin(), tunings.end(),
                   [](const auto& a, const auto& b) { return a.objective < b.objective; });
  std::vector<PublishedTuning> kept;
  for (auto& tuning : tunings) {
    if (std::all_of(kept.begin(), kept.end(), [&](const PublishedTuning& other) {
          return are_distinct(tuning.parameters, other.parameters);
        })) {
      kept.push_back(std::move(tuning));
    }
  }
  return kept;
}

}  // namespace

PublishedTuningResult tune_by_published_criterion(std::span<const PublishedRecording> recordings,
                                                  const PublishedParameters& base,
                                                  const PublishedTuningPlan& plan,
                                                  const MonteCarloProgress& progress,
                                                  const MonteCarloControl& control) {
  refuse_plan(plan);
  refuse_recordings(recordings, base);
  PublishedTuningResult result;
  result.base = base;
  result.plan = plan;
  for (const auto& recording : recordings) result.recordings.push_back(recording.name);

  std::vector<PublishedTuning> satisfying;
  const auto work = [&](std::uint64_t start) {
    return PublishedSearch(recordings, base, plan, control.stop).run(start);
  };
  const auto merge = [&](SearchedStart&& start) {
    PublishedTuning& best = start.best;
    result.evaluations += start.evaluations;
    if (best.satisfies) {
      ++result.satisfied;
      if (start.evaluations == 1) ++result.satisfied_at_once;
      satisfying.push_back(std::move(best));
    } else if (!result.closest || best.objective < result.closest->objective) {
      result.closest = std::move(best);
    }
  };
  result.starts = run_monte_carlo(plan.starts, 0, work, merge, progress, control);

  if (!satisfying.empty()) result.closest.reset();
  result.tunings = distinct_tunings(std::move(satisfying));
  const double initial = base.friction.initial_Ns_m;
  for (const auto& tuning : result.tunings) {
    const double friction = tuning.friction_Ns_m;
    const bool is_first = &tuning == &result.tunings.front();
    if (is_first || friction < result.lowest_friction_Ns_m) result.lowest_friction_Ns_m = friction;
    if (is_first || friction > result.highest_friction_Ns_m) {
      result.highest_friction_Ns_m = friction;
    }
    if (std::abs(friction - initial) <= plan.steady_share * initial) ++result.at_initial_friction;
  }
  return result;
}

}  // namespace condyle::host
