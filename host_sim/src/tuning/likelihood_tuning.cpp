// SPDX-License-Identifier: Apache-2.0
#include "tuning/likelihood_tuning.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"
#include "tuning/starting_values.h"

namespace condyle::host {
namespace {

using Point = std::vector<double>;

// The correlation time of noise after a manufacturer's low pass is short; a longer one would be
// motion.
constexpr double kShortestCorrelation = 0.05, kLongestCorrelation = 10;  // in sample times,
constexpr double kLongestCorrelation_s = 0.1;                            // or this
// Decrease of log l at the ends of a 95 % interval of one parameter: half of chi-square's 3.84.
constexpr double kLikelihoodOf95 = 1.92;
// Difference of held-out log l from which a model counts as better.
constexpr double kBetterBy = 10;
constexpr double kSearchShare = 0.6;  // of the time of a fit
constexpr int kProfilePoints = 25, kSurfacePoints = 31;

NoiseModel model_of(const Point& point) {
  return {std::exp(0.5 * point[0]), std::exp(point[1]), point.size() > 2 ? std::exp(point[2]) : 0};
}

double value_of(const NoiseModel& model, std::size_t i) {
  return i == 0 ? model.position_sd_m
                : (i == 1 ? model.jerk_density_m2_s5 : model.correlation_time_s);
}

// The likelihood of the fitted part.
class FitLikelihood {
 public:
  FitLikelihood(const std::vector<SplitRecording>& recordings, const MotionPriorParameters& prior)
      : recordings_(recordings), prior_(prior) {}

  double operator()(const Point& point) const {
    double sum = 0;
    for (const SplitRecording& split : recordings_) {
      for_each_innovation(split.recording().samples, model_of(point), prior_,
                          [&](std::size_t i, const Innovation& innovation) {
                            if (SplitRecording::is_held_out(split.stretch_of(i))) return;
                            sum += innovation.score();
                          });
    }
    return sum;
  }

  // The same for each fitted stretch.
  std::vector<double> by_stretch(const Point& point) const {
    std::vector<double> sums;
    for (const SplitRecording& split : recordings_) {
      const std::size_t first = sums.size();
      sums.resize(first + split.stretch_count());
      for_each_innovation(split.recording().samples, model_of(point), prior_,
                          [&](std::size_t i, const Innovation& innovation) {
                            const std::uint32_t stretch = split.stretch_of(i);
                            if (SplitRecording::is_held_out(stretch)) return;
                            sums[first + stretch] += innovation.score();
                          });
    }
    return sums;
  }

 private:
  const std::vector<SplitRecording>& recordings_;
  const MotionPriorParameters& prior_;
};

// Standard deviations of the logarithms at the optimum.
struct LogSds {
  std::vector<double> by_curvature, by_either;  // the larger of both
};

LogSds log_sds(const FitLikelihood& likelihood, const Point& best) {
  constexpr double kStep = 0.02;
  const auto n = static_cast<Eigen::Index>(best.size());
  const auto moved = [&](Eigen::Index i, double by_i, Eigen::Index j, double by_j) {
    Point point = best;
    point[static_cast<std::size_t>(i)] += by_i;
    point[static_cast<std::size_t>(j)] += by_j;
    return point;
  };
  const double middle = likelihood(best);
  Eigen::MatrixXd H(n, n);
  std::vector<std::vector<double>> slopes;
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::vector<double> up = likelihood.by_stretch(moved(i, kStep, i, 0));
    const std::vector<double> down = likelihood.by_stretch(moved(i, -kStep, i, 0));
    double up_sum = 0, down_sum = 0;
    slopes.emplace_back();
    for (std::size_t k = 0; k < up.size(); ++k) {
      slopes.back().push_back((up[k] - down[k]) / (2 * kStep));
      up_sum += up[k];
      down_sum += down[k];
    }
    H(i, i) = -(up_sum - 2 * middle + down_sum) / (kStep * kStep);
    for (Eigen::Index j = 0; j < i; ++j) {
      const double mixed =
          likelihood(moved(i, kStep, j, kStep)) - likelihood(moved(i, kStep, j, -kStep)) -
          likelihood(moved(i, -kStep, j, kStep)) + likelihood(moved(i, -kStep, j, -kStep));
      H(i, j) = H(j, i) = -mixed / (4 * kStep * kStep);
    }
  }
  const std::vector<double> unknown(best.size(), std::numeric_limits<double>::infinity());
  LogSds sds{unknown, unknown};
  const Eigen::LLT<Eigen::MatrixXd> factor(H);
  if (factor.info() != Eigen::Success) return sds;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, n);
  std::size_t used_stretches = 0;
  for (std::size_t k = 0; k < slopes[0].size(); ++k) {
    Eigen::VectorXd slope(n);
    for (Eigen::Index i = 0; i < n; ++i) slope[i] = slopes[static_cast<std::size_t>(i)][k];
    if (!slope.isZero(0)) ++used_stretches;
    J += slope * slope.transpose();
  }
  const double fitted = static_cast<double>(used_stretches);
  if (fitted > 1) J *= fitted / (fitted - 1);
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::MatrixXd robust = inverse * J * inverse;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    sds.by_curvature[k] = std::sqrt(inverse(i, i));
    sds.by_either[k] = std::sqrt(std::max(inverse(i, i), robust(i, i)));
  }
  return sds;
}

// The inputs of a fit, except its start.
struct FitSetting {
  const std::vector<SplitRecording>& recordings;
  const LikelihoodPlan& plan;
  const SearchBounds& bounds;
  const MonteCarloControl& control;
};

// The best log l with coordinate `held` fixed at `value`, starting from `point`, which becomes the
// optimum.
double profile_at(const FitLikelihood& likelihood, const FitSetting& setting, std::size_t held,
                  double value, Point& point) {
  const SearchBounds& bounds = setting.bounds;
  Point start;
  SearchBounds rest;
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (i == held) continue;
    start.push_back(point[i]);
    rest.low.push_back(bounds.low[i]);
    rest.high.push_back(bounds.high[i]);
  }
  const auto whole = [held, value](const Point& others) {
    Point all = others;
    all.insert(all.begin() + static_cast<std::ptrdiff_t>(held), value);
    return all;
  };
  std::uint64_t evaluations = 0;
  ClimbSettings settings;
  settings.is_enough = setting.control.stop;
  const SearchOptimum found = climb([&](const Point& others) { return likelihood(whole(others)); },
                                    rest, start, evaluations, settings);
  point = whole(found.point);
  return found.value;
}

// True if log l falls by kLikelihoodOf95 on the way from the optimum to both bounds.
bool is_bounded(const FitLikelihood& likelihood, const FitSetting& setting, std::size_t held,
                const SearchOptimum& best) {
  for (const double end : {setting.bounds.low[held], setting.bounds.high[held]}) {
    Point point = best.point;
    if (profile_at(likelihood, setting, held, end, point) > best.value - kLikelihoodOf95) {
      return false;
    }
  }
  return true;
}

std::vector<ProfilePoint> profile(const FitLikelihood& likelihood, const FitSetting& setting,
                                  std::size_t held, const SearchOptimum& best, double log_sd) {
  const SearchBounds& bounds = setting.bounds;
  const double reach = std::isfinite(log_sd) ? std::clamp(4 * log_sd, 0.01, 6.0) : 6.0;
  const double low = std::max(bounds.low[held], best.point[held] - reach);
  const double high = std::min(bounds.high[held], best.point[held] + reach);
  std::vector<ProfilePoint> points;
  Point point = best.point;
  for (int i = 0; i < kProfilePoints; ++i) {
    const double at = low + (high - low) * i / (kProfilePoints - 1);
    const double value = profile_at(likelihood, setting, held, at, point);
    points.push_back({value_of(model_of(point), held), value - best.value});
  }
  return points;
}

FittedModel fit(const FitSetting& setting, const Point& start,
                const std::function<void(double)>& show) {
  const FitLikelihood likelihood(setting.recordings, setting.plan.prior);
  FittedModel fitted;
  fitted.search = search(
      likelihood, setting.bounds,
      draw_starts(start, std::log(kStartFactor), setting.bounds, setting.plan.starts,
                  setting.plan.seed),
      [&](std::uint64_t merged, std::uint64_t runs) {
        show(kSearchShare * static_cast<double>(merged) / static_cast<double>(runs));
      },
      setting.control);
  if (fitted.search.stopped) return fitted;
  const SearchOptimum& best = fitted.search.optima.front();
  fitted.values = model_of(best.point);
  fitted.log_likelihood = best.value;
  const bool is_alone = fitted.search.optima.size() < 2 ||
                        fitted.search.optima[1].value < best.value - kLikelihoodOf95;
  fitted.is_unique =
      is_alone || 2 * static_cast<std::size_t>(best.reached_by) > setting.plan.starts;
  const LogSds sds = log_sds(likelihood, best.point);
  for (std::size_t i = 0; i < best.point.size(); ++i) {
    FittedParameter parameter;
    parameter.value = value_of(fitted.values, i);
    const double of_logarithm = i == 0 ? 0.5 : 1;  // of sigma, not of its square
    parameter.log_sd = of_logarithm * sds.by_either[i];
    parameter.at_bound = best.point[i] - setting.bounds.low[i] < kSamePoint ||
                         setting.bounds.high[i] - best.point[i] < kSamePoint;
    parameter.is_bounded = is_bounded(likelihood, setting, i, best);
    if (setting.plan.with_surface) {
      parameter.profile = profile(likelihood, setting, i, best, sds.by_curvature[i]);
    }
    fitted.parameters.push_back(std::move(parameter));
    show(kSearchShare +
         (1 - kSearchShare) * static_cast<double>(i + 1) / static_cast<double>(best.point.size()));
  }
  fitted.held_out = cross_validate(setting.recordings, fitted.values, setting.plan.prior);
  return fitted;
}

SearchBounds bounds_of(const LikelihoodPlan& plan) {
  SearchBounds bounds;
  bounds.low = {2 * std::log(plan.position_sd_m.lowest), std::log(plan.jerk_density_m2_s5.lowest)};
  bounds.high = {2 * std::log(plan.position_sd_m.highest),
                 std::log(plan.jerk_density_m2_s5.highest)};
  return bounds;
}

LikelihoodSurface draw_surface(const FitSetting& setting, const FittedModel& fitted) {
  const FitLikelihood likelihood(setting.recordings, setting.plan.prior);
  LikelihoodSurface surface;
  const auto coordinate = [&](std::size_t axis, int i) {
    constexpr double kReach = 5;
    const double middle = fitted.search.optima.front().point[axis];
    const double low = std::max(setting.bounds.low[axis], middle - kReach);
    const double high = std::min(setting.bounds.high[axis], middle + kReach);
    return low + (high - low) * i / (kSurfacePoints - 1);
  };
  for (int i = 0; i < kSurfacePoints; ++i) {
    surface.position_sd_m.push_back(std::exp(0.5 * coordinate(0, i)));
    surface.jerk_density_m2_s5.push_back(std::exp(coordinate(1, i)));
  }
  (void)run_monte_carlo(
      kSurfacePoints, 0,
      [&](std::uint64_t row) {
        std::vector<double> values;
        for (int i = 0; i < kSurfacePoints; ++i) {
          values.push_back(likelihood({coordinate(0, i), coordinate(1, static_cast<int>(row))}) -
                           fitted.log_likelihood);
        }
        return values;
      },
      [&](std::vector<double>&& values) {
        surface.log_likelihood.insert(surface.log_likelihood.end(), values.begin(), values.end());
      },
      {}, setting.control);
  return surface;
}

// `model` clamped to the bounds.
NoiseModel within(const LikelihoodPlan& plan, NoiseModel model) {
  const auto clamped = [](double value, Range range) {
    return std::clamp(value, range.lowest, range.highest);
  };
  model.position_sd_m = clamped(model.position_sd_m, plan.position_sd_m);
  model.jerk_density_m2_s5 = clamped(model.jerk_density_m2_s5, plan.jerk_density_m2_s5);
  return model;
}

// Distinct steps of the recordings, shortest first.
std::vector<double> steps_of(const std::vector<TuningRecording>& recordings) {
  std::vector<double> steps_s;
  for (const TuningRecording& recording : recordings) steps_s.push_back(recording.median_step_s);
  std::sort(steps_s.begin(), steps_s.end());
  const auto alike = [](double one, double other) { return other < 1.01 * one; };
  steps_s.erase(std::unique(steps_s.begin(), steps_s.end(), alike), steps_s.end());
  return steps_s;
}

// A stand-in whose intervals are not too narrow at any step: the largest noise, and the smallest
// q/R.
EquivalentWhiteNoise stand_in_of(const NoiseModel& model, const std::vector<double>& steps_s) {
  EquivalentWhiteNoise all;
  double least_ratio = std::numeric_limits<double>::infinity();
  for (const double step_s : steps_s) {
    const EquivalentWhiteNoise one = equivalent_white_noise(model, step_s);
    const double R = one.white.position_sd_m * one.white.position_sd_m;
    least_ratio = std::min(least_ratio, one.white.jerk_density_m2_s5 / R);
    all.white.position_sd_m = std::max(all.white.position_sd_m, one.white.position_sd_m);
    all.velocity_error_m_s = std::max(all.velocity_error_m_s, one.velocity_error_m_s);
    all.best_velocity_error_m_s =
        std::max(all.best_velocity_error_m_s, one.best_velocity_error_m_s);
  }
  all.white.jerk_density_m2_s5 = least_ratio * all.white.position_sd_m * all.white.position_sd_m;
  return all;
}

// True if all parameters of `model` except the correlation time are known. That one may be at its
// upper bound, because a longer one would fit as well.
bool is_usable(const FittedModel& model) {
  const auto is_known = [](const FittedParameter& parameter) {
    return parameter.is_bounded && !parameter.at_bound && std::isfinite(parameter.log_sd);
  };
  return is_known(model.parameters[0]) && is_known(model.parameters[1]);
}

// Refuses recordings without a part to fit or to hold out.
void check_split(const std::vector<SplitRecording>& recordings, const LikelihoodPlan& plan) {
  std::size_t fitted = 0, held_out = 0;
  for (const SplitRecording& split : recordings) {
    for_each_innovation(split.recording().samples, NoiseModel{1e-4, 10, 0}, plan.prior,
                        [&](std::size_t i, const Innovation&) {
                          ++(SplitRecording::is_held_out(split.stretch_of(i)) ? held_out : fitted);
                        });
  }
  constexpr std::size_t kFewest = 20;
  if (fitted >= kFewest && held_out >= kFewest) return;
  throw InputError(
      recordings.front().recording().name,
      fmt::format("has too many gaps: {} innovations to fit and {} to hold out", fitted, held_out),
      "record longer without gaps");
}

}  // namespace

LikelihoodTuning tune_by_likelihood(const std::vector<TuningRecording>& recordings,
                                    const LikelihoodPlan& plan,
                                    const std::function<void(double)>& show,
                                    const MonteCarloControl& control) {
  LikelihoodTuning tuning;
  const std::vector<SplitRecording> split(recordings.begin(), recordings.end());
  tuning.start = plan.start.value_or(starting_values(recordings));
  check_split(split, plan);
  SearchBounds bounds = bounds_of(plan);
  const bool is_filtered =
      std::any_of(recordings.begin(), recordings.end(),
                  [](const TuningRecording& recording) { return recording.filtered_lag > 0; });
  const double white_share = is_filtered ? 0.3 : 0.8;
  tuning.start = within(plan, tuning.start);
  Point start = {2 * std::log(tuning.start.position_sd_m),
                 std::log(tuning.start.jerk_density_m2_s5)};
  const FitSetting setting{split, plan, bounds, control};
  tuning.white = fit(setting, start, [&](double share) { show(share * white_share); });
  tuning.stopped = tuning.white.search.stopped;
  if (tuning.stopped) return tuning;
  if (plan.with_surface) tuning.surface = draw_surface(setting, tuning.white);
  tuning.reasons = reasons_against_white(split, tuning.white.held_out);
  tuning.written = within(plan, tuning.white.values);
  tuning.written_check = tuning.white.held_out;
  if (!is_filtered) return tuning;

  const std::vector<double> steps_s = steps_of(recordings);
  const double step_s = steps_s.back();
  bounds.low.push_back(std::log(kShortestCorrelation * step_s));
  bounds.high.push_back(std::log(std::max(kLongestCorrelation * step_s, kLongestCorrelation_s)));
  start = tuning.white.search.optima.front().point;
  start.push_back(std::log(step_s));
  tuning.correlated =
      fit(setting, start, [&](double share) { show(white_share + share * (1 - white_share)); });
  FittedModel& correlated = *tuning.correlated;
  tuning.stopped = correlated.search.stopped;
  if (tuning.stopped) return tuning;
  const ScoreDifference gain = compare_scores(correlated.held_out, tuning.white.held_out);
  const double of_held_out = gain.mean * static_cast<double>(correlated.held_out.count);
  tuning.correlated_serves =
      of_held_out > kBetterBy && gain.mean > 2 * gain.standard_error && is_usable(correlated);
  if (!tuning.correlated_serves) return tuning;
  tuning.stand_in = stand_in_of(correlated.values, steps_s);
  tuning.written = within(plan, tuning.stand_in->white);
  tuning.written_check = cross_validate(split, tuning.written, plan.prior);
  return tuning;
}

}  // namespace condyle::host
