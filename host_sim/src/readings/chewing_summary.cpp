// SPDX-License-Identifier: Apache-2.0
#include "readings/chewing_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "statistics/chi_square.h"

namespace condyle::host {
namespace {

constexpr double kLeastSide_mm = 1;
constexpr std::size_t kLeastForScatter = 3, kLeastThird = 3;

using Values = std::vector<UncertainValue>;

// The reading `name` of the cycles that have it; `hidden`: how many have one that is not known.
Values values_of(const Analysis& analysis, std::string_view name, int& hidden) {
  const auto names = readings_of_cycle(analysis.has_landmarks);
  const auto at =
      static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  Values values;
  for (const AnalysedCycle& cycle : analysis.cycles) {
    if (at >= cycle.values.size()) continue;
    if (std::isfinite(cycle.values[at].value)) values.push_back(cycle.values[at]);
    if (cycle.values[at].is_hidden) ++hidden;
  }
  return values;
}

// Mean and standard deviation of numbers.
std::array<double, 2> moments(const std::vector<double>& numbers) {
  const double count = static_cast<double>(numbers.size());
  const double mean = std::accumulate(numbers.begin(), numbers.end(), 0.0) / count;
  double squares = 0;
  for (const double number : numbers) squares += (number - mean) * (number - mean);
  return {mean, std::sqrt(squares / (count - 1))};
}

// `measure(numbers)` of the values, with what smoothing and each shared error change in it.
template <class Measure>
UncertainValue with_shared_errors(const Values& values, const Measure& measure) {
  std::vector<double> numbers;
  const auto measure_of = [&](const auto& number) {
    numbers.clear();
    for (const UncertainValue& value : values) numbers.push_back(number(value));
    return measure(numbers);
  };
  UncertainValue result;
  result.value = measure_of([](const UncertainValue& value) { return value.value; });
  const auto changed_by = [&](const auto& part) {
    return measure_of([&part](const UncertainValue& value) { return value.value + part(value); }) -
           result.value;
  };
  result.doubt = changed_by([](const UncertainValue& value) { return value.doubt; });
  for (std::size_t i = 0; i < result.corrections.size(); ++i) {
    result.corrections[i] =
        changed_by([i](const UncertainValue& value) { return value.corrections[i]; });
  }
  for (std::size_t i = 0; i < values[0].fixed.size(); ++i) {
    result.fixed.push_back(changed_by([i](const UncertainValue& value) { return value.fixed[i]; }));
  }
  return result;
}

double mean_variance(const Values& values) {
  double sum = 0;
  for (const UncertainValue& value : values) sum += value.noise_sd * value.noise_sd;
  return sum / static_cast<double>(values.size());
}

// Of an error that differs from cycle to cycle: noise, and what smoothing changed.
double own_variance(const UncertainValue& value) {
  const double of_smoothing = value.systematic() / kHalf95;
  return value.noise_sd * value.noise_sd + of_smoothing * of_smoothing;
}

// The standard deviation `sd_of(numbers)` without that of the measurement; `scale`: of the result.
// `method_share`: error of the method in each value, as a share of it.
CycleSummary scatter(std::string_view name, const Values& values, bool is_relative,
                     double method_share) {
  CycleSummary summary{name, Side::none, {}, {}, {}};
  if (values.size() < kLeastForScatter) {
    summary.value.missing = "fewer than three cycles";
    return summary;
  }
  const double noise = mean_variance(values), count = static_cast<double>(values.size());
  double mean = 0, variance = 0, observed = 0;
  const auto measure = [&](const std::vector<double>& numbers) {
    const auto [middle, sd] = moments(numbers);
    mean = middle;
    observed = sd * sd;
    variance = std::max(observed - noise, 0.0);
    return std::sqrt(variance) * (is_relative ? 100 / std::abs(middle) : 1);
  };
  summary.value = with_shared_errors(values, measure);
  std::vector<double> numbers;
  for (const UncertainValue& value : values) numbers.push_back(value.value);
  measure(numbers);
  const double scale = is_relative ? 100 / std::abs(mean) : 1;
  // Of the variance: of the products of scatter and error, and of the error's own square.
  double squares = 0;
  for (const UncertainValue& value : values) {
    const double error =
        own_variance(value) + method_share * method_share * value.value * value.value;
    const double from_mean = value.value - mean;
    squares += 4 * from_mean * from_mean * error + 2 * error * error;
  }
  const double of_variance = std::sqrt(squares) / (count - 1);
  const double highest = std::sqrt(variance + kHalf95 * of_variance) * scale;
  const double lowest = std::sqrt(std::max(variance - kHalf95 * of_variance, 0.0)) * scale;
  const double shared = summary.value.half_interval();
  summary.interval = {
      std::max(summary.value.value - std::hypot(summary.value.value - lowest, shared), 0.0),
      summary.value.value + std::hypot(highest - summary.value.value, shared)};
  if (observed < noise) {
    summary.remark = "the scatter is below that of the measurement; its value is set to 0";
  }
  return summary;
}

// Mean of the last third minus mean of the first third, and how much of it the scatter explains.
CycleSummary change(std::string_view name, const Values& values) {
  CycleSummary summary{name, Side::none, {}, {}, {}};
  const std::size_t third = values.size() / 3;
  if (third < kLeastThird) {
    summary.value.missing = "fewer than nine cycles";
    return summary;
  }
  double scatter = 0;
  const auto size = static_cast<std::ptrdiff_t>(third);
  const auto measure = [&](const std::vector<double>& numbers) {
    const auto [first, first_sd] = moments({numbers.begin(), numbers.begin() + size});
    const auto [last, last_sd] = moments({numbers.end() - size, numbers.end()});
    scatter = (first_sd * first_sd + last_sd * last_sd) / static_cast<double>(third);
    return last - first;
  };
  summary.value = with_shared_errors(values, measure);
  double own = 0;
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    own += own_variance(*(values.begin() + i)) + own_variance(*(values.end() - 1 - i));
  }
  summary.value.noise_sd = std::sqrt(own) / static_cast<double>(third);
  std::vector<double> numbers;
  for (const UncertainValue& value : values) numbers.push_back(value.value);
  measure(numbers);
  const double factor = student_t_quantile(0.975, 2 * (static_cast<double>(third) - 1));
  summary.remark = fmt::format("cycles that only scatter as these do change by up to {:.2g} {}",
                               factor * std::sqrt(scatter), definition_of(name).unit);
  summary.is_derived = false;
  return summary;
}

// Number of cycles that surely are something, seem so, may be so.
struct Tally {
  double sure = 0, seen = 0, possible = 0;
  void add(bool is_sure, bool is_seen, bool may_be) {
    sure += is_sure;
    seen += is_seen;
    possible += may_be || is_seen;
  }
  CycleSummary summary(std::string_view name, Side side, const std::string& remark) const {
    CycleSummary summary{name, side, {}, std::array{std::min(sure, seen), possible}, remark};
    summary.value.value = seen;
    return summary;
  }
};

// A number with its 95 % interval.
struct Bounded {
  double value, half;
  bool surely_above(double limit) const { return value - half > limit; }
  bool maybe_above(double limit) const { return value + half > limit; }
  Bounded operator-() const { return {-value, half}; }
};
Bounded bounded(const UncertainValue& value) {
  return {value.value, value.half_interval()};
}

// Wilson's interval of a share of `count`: its lower end, or its upper one.
double wilson(double share_count, double count, int end) {
  const double p = share_count / count, z2 = kHalf95 * kHalf95;
  const double root = std::sqrt(p * (1 - p) / count + z2 / (4 * count * count));
  return (p + z2 / (2 * count) + end * kHalf95 * root) / (1 + z2 / count);
}

struct Sides {
  Tally left, right, midline, reversed;
  int stated = 0, unknown = 0;
};

Sides sides_of(const Analysis& analysis) {
  Sides sides;
  for (const AnalysedCycle& cycle : analysis.cycles) {
    if (cycle.number == 0) continue;
    if (cycle.side.empty()) {
      ++sides.unknown;
      continue;
    }
    const Bounded y = bounded(cycle.directions.closing_side_mm);
    const Bounded area = bounded(cycle.directions.frontal_area_mm2);
    const bool is_left = cycle.side == "left", is_right = cycle.side == "right";
    bool surely_left = is_left, surely_right = is_right, maybe_left = is_left;
    bool maybe_right = is_right;
    if (cycle.is_side_stated) {
      ++sides.stated;
    } else {
      surely_left = y.surely_above(kLeastSide_mm);
      surely_right = (-y).surely_above(kLeastSide_mm);
      maybe_left = y.maybe_above(kLeastSide_mm);
      maybe_right = (-y).maybe_above(kLeastSide_mm);
    }
    const bool is_midline = !is_left && !is_right;
    sides.left.add(surely_left, is_left, maybe_left);
    sides.right.add(surely_right, is_right, maybe_right);
    sides.midline.add(!maybe_left && !maybe_right, is_midline, !surely_left && !surely_right);
    if (!std::isfinite(area.value)) continue;
    sides.reversed.add(
        (surely_left && (-area).surely_above(0)) || (surely_right && area.surely_above(0)),
        (is_left && area.value < 0) || (is_right && area.value > 0),
        (maybe_left && (-area).maybe_above(0)) || (maybe_right && area.maybe_above(0)));
  }
  return sides;
}

void add_sides(const Analysis& analysis, std::vector<CycleSummary>& summaries) {
  const Sides sides = sides_of(analysis);
  std::string remark = "the side is that to which the jaw closes, not that of the food";
  if (sides.stated > 0) remark = fmt::format("the side of {} cycles is stated", sides.stated);
  if (sides.unknown > 0) {
    remark += fmt::format("; that of {} cycles is not known", sides.unknown);
  }
  summaries.push_back(sides.left.summary("side_cycle_count", Side::left, remark));
  summaries.push_back(sides.right.summary("side_cycle_count", Side::right, remark));
  summaries.push_back(sides.midline.summary("midline_cycle_count", Side::none, remark));
  summaries.push_back(sides.reversed.summary("reversed_loop_count", Side::none, remark));
  CycleSummary laterality{"laterality_index", Side::none, {}, {}, remark};
  const Tally &left = sides.left, &right = sides.right;
  const double count = left.seen + right.seen;
  if (count == 0) {
    laterality.value.missing = "no cycle is to one side";
  } else {
    laterality.value.value = (right.seen - left.seen) / count;
    const double least = std::max(right.sure + left.possible, 1.0);
    const double most = std::max(right.possible + left.sure, 1.0);
    laterality.interval = {2 * wilson(right.sure, least, -1) - 1,
                           2 * wilson(right.possible, most, 1) - 1};
  }
  summaries.push_back(laterality);
}

}  // namespace

void find_sides(Analysis& analysis) {
  // Of stated left, right: found left, right, midline.
  int table[2][3] = {};
  for (AnalysedCycle& cycle : analysis.cycles) {
    if (cycle.number == 0 || !analysis.has_landmarks) continue;
    const Bounded y = bounded(cycle.directions.closing_side_mm);
    if (std::isfinite(y.value)) {
      const double least_mm = std::max(kLeastSide_mm, 2 / kHalf95 * y.half);
      cycle.side = std::abs(y.value) < least_mm ? "midline" : y.value > 0 ? "left" : "right";
    }
    for (const Task& task : analysis.tasks) {
      const double middle_s = (cycle.cycle.begin_s + cycle.cycle.end_s) / 2;
      if (task.kind != TaskKind::chewing || task.side == Side::none || middle_s < task.begin_s ||
          middle_s > task.end_s) {
        continue;
      }
      if (!cycle.side.empty()) {
        ++table[task.side == Side::left ? 0 : 1][cycle.side == "left"    ? 0
                                                 : cycle.side == "right" ? 1
                                                                         : 2];
      }
      cycle.side = name_of(task.side);
      cycle.is_side_stated = true;
    }
  }
  for (const Side side : {Side::left, Side::right}) {
    const auto& [left, right, midline] = table[side == Side::left ? 0 : 1];
    if (left + right + midline == 0) continue;
    analysis.notes.push_back(fmt::format(
        "chewing stated {}: of {} cycles {} close to the left, {} to the right, {} in the midline",
        name_of(side), left + right + midline, left, right, midline));
  }
}

std::vector<CycleSummary> summaries_of(const Analysis& analysis) {
  struct Names {
    std::string_view cycle, sd, relative, change;
    bool needs_landmarks;
    double method_share = 0;
  };
  constexpr Names all[] = {
      {"cycle_duration_s", "cycle_duration_sd_s", "cycle_duration_cv_percent",
       "cycle_duration_change_s", false},
      {"closing_peak_speed_mm_s", "closing_peak_speed_sd_mm_s", "closing_peak_speed_cv_percent",
       "closing_peak_speed_change_mm_s", false, 0.003},
      {"cycle_height_mm", "cycle_height_sd_mm", "cycle_height_cv_percent", "cycle_height_change_mm",
       true},
      {"cycle_width_mm", "cycle_width_sd_mm", "cycle_width_cv_percent", "cycle_width_change_mm",
       true},
  };
  std::vector<CycleSummary> summaries;
  const auto withhold = [&summaries](
                            std::string_view name, Side side,
                            std::string reason = "it needs landmarks; give --landmarks FILE") {
    CycleSummary summary{name, side, {}, {}, {}};
    summary.value.missing = std::move(reason);
    summaries.push_back(summary);
  };
  for (const Names& names : all) {
    if (names.needs_landmarks && !analysis.has_landmarks) {
      for (const auto name : {names.sd, names.relative, names.change}) withhold(name, Side::none);
      continue;
    }
    int hidden = 0;
    const Values values = values_of(analysis, names.cycle, hidden);
    if (hidden > 0) {
      const std::string reason =
          fmt::format("{} is not known for {} of {} cycles, which may differ from the others",
                      names.cycle, hidden, values.size() + static_cast<std::size_t>(hidden));
      for (const auto name : {names.sd, names.relative, names.change}) {
        withhold(name, Side::none, reason);
      }
      continue;
    }
    summaries.push_back(scatter(names.sd, values, false, names.method_share));
    summaries.push_back(scatter(names.relative, values, true, names.method_share));
    summaries.push_back(change(names.change, values));
  }
  if (analysis.has_landmarks) {
    add_sides(analysis, summaries);
  } else {
    for (const Side side : {Side::left, Side::right}) withhold("side_cycle_count", side);
    for (const auto name : {"midline_cycle_count", "reversed_loop_count", "laterality_index"}) {
      withhold(name, Side::none);
    }
  }
  return summaries;
}

}  // namespace condyle::host
