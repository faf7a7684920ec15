// SPDX-License-Identifier: Apache-2.0
#include "recordings/csv_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "condyle/estimator/sample.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

// Fewer samples do not refute a unit that the file states.
constexpr std::size_t kLeastSamples = 50;
constexpr double kSlowest_Hz = 5, kFastest_Hz = 5000;
// No file that states its unit may be beyond.
constexpr double kAbsurd_Hz = 50'000, kAbsurdRange_m = 5;
// Samples farther apart are not related by any estimator, unless its parameters say so.
constexpr double kSlowestStated_Hz = 4;
struct TimeUnit {
  const char* name;
  double each;  // in seconds
};
constexpr std::array<TimeUnit, 4> kTimeUnits{{{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}};

std::optional<double> median_step(const std::vector<double>& times) {
  std::vector<double> steps;
  double last = std::nan("");
  for (const double time : times) {
    if (time - last > 0) steps.push_back(time - last);
    if (std::isfinite(time)) last = time;
  }
  if (steps.empty()) return std::nullopt;
  return lower_quantile(steps, 0.5);
}

// What the values of a column are like, outliers left out.
struct Spread {
  double middle = 0;  // absolute value of the median
  double range = 0;   // from the 5 % to the 95 % quantile
  double step = 0;    // 90 % of the steps between neighbours are at most this
};

std::optional<Spread> spread_of(const std::vector<double>& column) {
  std::vector<double> values, steps;
  for (const double value : column) {
    if (!std::isfinite(value)) continue;
    if (!values.empty()) steps.push_back(std::abs(value - values.back()));
    values.push_back(value);
  }
  if (values.size() < 2) return std::nullopt;
  Spread spread;
  spread.middle = std::abs(lower_quantile(values, 0.5));
  const double low = lower_quantile(values, 0.05);
  spread.range = lower_quantile(values, 0.95) - low;
  spread.step = lower_quantile(steps, 0.9);
  return spread;
}

// The column that moves farthest, and the greatest distance of all.
std::optional<Spread> widest(const std::vector<std::vector<double>>& columns) {
  std::optional<Spread> result;
  double farthest = 0;
  for (const std::vector<double>& column : columns) {
    const std::optional<Spread> spread = spread_of(column);
    if (!spread) continue;
    farthest = std::max(farthest, spread->middle);
    if (!result || spread->range > result->range) result = spread;
  }
  if (result) result->middle = farthest;
  return result;
}

std::size_t count(const std::vector<double>& values) {
  return static_cast<std::size_t>(std::count_if(values.begin(), values.end(),
                                                [](double value) { return std::isfinite(value); }));
}

std::string rate_text(double rate_Hz) {
  return rate_Hz >= 1000 ? fmt::format("{:.3g} kHz", rate_Hz / 1000)
                         : fmt::format("{:.3g} Hz", rate_Hz);
}

}  // namespace

UnitGuess guess_time_unit(const std::vector<double>& times) {
  UnitGuess guess;
  const std::optional<double> step = median_step(times);
  if (!step) {
    guess.reason = "its values do not increase";
    return guess;
  }
  guess.is_count = *step == 1 && std::all_of(times.begin(), times.end(), [](double time) {
    return !std::isfinite(time) || time == std::floor(time);
  });
  if (guess.is_count) {
    guess.reason = "its steps of 1 can be seconds, milliseconds or frames";
    return guess;
  }
  std::vector<std::string> others;
  for (const auto& [unit, each] : kTimeUnits) {
    const double rate_Hz = 1 / (*step * each);
    if (rate_Hz >= kSlowest_Hz && rate_Hz <= kFastest_Hz) {
      guess.unit = unit;
      guess.each = each;
      guess.reason = fmt::format("a step of {:g} {} is {}", *step, unit, rate_text(rate_Hz));
    } else if (each >= 1e-3) {
      others.push_back(fmt::format("in {} {}", unit, rate_text(rate_Hz)));
    }
  }
  if (guess.each > 0) {
    for (const std::string& other : others) guess.reason += fmt::format(", {}", other);
  } else {
    guess.reason = fmt::format("its step of {:g} makes no usual rate in s, ms, us or ns", *step);
  }
  return guess;
}

UnitGuess guess_length_unit(const std::vector<std::vector<double>>& columns) {
  // A jaw with its head moves by 0.5 mm to 0.5 m; a tracker is at most 10 m away.
  constexpr double kLeastRange_m = 0.5e-3, kMostRange_m = 0.5, kMostOfJaw_m = 0.15,
                   kFarthest_m = 10;
  constexpr double kMostNoise = 0.1;  // of the range
  UnitGuess guess;
  const std::optional<Spread> spread = widest(columns);
  if (!spread) {
    guess.reason = "its values do not tell";
    return guess;
  }
  const bool may_be_mm = spread->range >= kLeastRange_m * 1e3 || spread->middle > kFarthest_m;
  const bool may_be_m = spread->range <= kMostRange_m && spread->middle <= kFarthest_m;
  if (may_be_mm && !may_be_m) {
    guess.unit = "mm";
    guess.each = 1e-3;
    guess.reason =
        fmt::format("in m they would move by {:.3g} m at {:.3g} m", spread->range, spread->middle);
    if (spread->range > 5e3) {
      guess.each = 0;
      guess.reason =
          fmt::format("they move by {:.3g}, too far for a jaw in mm or m", spread->range);
    }
    return guess;
  }
  const bool is_motion = spread->range > 0 && spread->step < kMostNoise * spread->range;
  if (may_be_m && !may_be_mm && is_motion && spread->range >= 2e-3 &&
      spread->range <= kMostOfJaw_m) {
    guess.unit = "m";
    guess.each = 1;
    guess.reason = fmt::format("in mm they would move by {:.2g} mm", spread->range);
    return guess;
  }
  guess.reason = fmt::format("they move by {:.3g}, which can be mm or m", spread->range);
  return guess;
}

UnitGuess guess_length_unit(const std::map<std::string, std::vector<std::vector<double>>>& points) {
  UnitGuess found;
  std::string first;
  std::vector<std::vector<double>> all;
  for (const auto& [name, columns] : points) {
    all.insert(all.end(), columns.begin(), columns.end());
    const UnitGuess guess = guess_length_unit(columns);
    if (guess.each == 0) continue;
    if (found.each > 0 && guess.each != found.each) {
      found.each = 0;
      found.reason =
          fmt::format("{} moves as if in {}, {} as if in {}", first, found.unit, name, guess.unit);
      return found;
    }
    if (found.each == 0) first = name;
    found = guess;
  }
  return found.each > 0 ? found : guess_length_unit(all);
}

bool is_counter_or_empty(const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) != std::isfinite(values[0])) return false;
    if (std::isfinite(values[i]) && values[i] != values[0] + static_cast<double>(i)) return false;
  }
  return true;
}

TimesDoubt doubt_of_times(const std::vector<double>& times, double each) {
  const std::optional<double> step = median_step(times);
  if (!step || count(times) < kLeastSamples) return {};
  const double rate_Hz = 1 / (*step * each);
  if (rate_Hz >= kSlowestStated_Hz && rate_Hz <= kFastest_Hz) return {};
  TimesDoubt doubt;
  doubt.is_absurd = rate_Hz > kAbsurd_Hz;
  for (const TimeUnit& unit : kTimeUnits) {
    const double other_Hz = 1 / (*step * unit.each);
    if (other_Hz < kSlowest_Hz || other_Hz > kFastest_Hz) continue;
    doubt.unit = unit.name;
    doubt.each = unit.each;
    doubt.problem = fmt::format("its steps are {}, which no jaw is recorded at; in {} they are {}",
                                rate_text(rate_Hz), unit.name, rate_text(other_Hz));
  }
  if (doubt.unit.empty() && doubt.is_absurd) {
    doubt.problem = fmt::format("its steps of {:.3g} s are {}, which no jaw is recorded at",
                                *step * each, rate_text(rate_Hz));
  }
  return doubt;
}

std::string problem_of_distance(const std::vector<std::vector<double>>& columns_m) {
  if (columns_m.empty() || count(columns_m[0]) < kLeastSamples) return "";
  for (const std::vector<double>& column_m : columns_m) {
    double farthest_m = 0;
    std::size_t far = 0;
    for (const double value_m : column_m) {
      if (!(std::abs(value_m) > kFarthestPosition_m)) continue;
      farthest_m = std::max(farthest_m, std::abs(value_m));
      ++far;
    }
    if (2 * far > count(column_m)) {
      return fmt::format("most positions are beyond {:g} m, up to {:.3g} m, where no jaw is",
                         kFarthestPosition_m, farthest_m);
    }
  }
  return "";
}

std::string problem_of_places(const std::vector<std::vector<double>>& columns_m) {
  if (columns_m.empty() || count(columns_m[0]) < kLeastSamples) return "";
  if (std::string problem = problem_of_distance(columns_m); !problem.empty()) return problem;
  // Single values out of range are missing ones; the others tell the unit.
  std::vector<std::vector<double>> near_m = columns_m;
  for (std::vector<double>& column_m : near_m) {
    for (double& value_m : column_m) {
      if (std::abs(value_m) > kFarthestPosition_m) value_m = std::nan("");
    }
  }
  const std::optional<Spread> spread = widest(near_m);
  if (!spread || spread->range <= kAbsurdRange_m) return "";
  return fmt::format("the positions move by {:.3g} m, which no jaw does", spread->range);
}

}  // namespace condyle::host
