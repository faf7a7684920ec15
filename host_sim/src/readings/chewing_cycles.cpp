// SPDX-License-Identifier: Apache-2.0
#include "readings/chewing_cycles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "readings/cycle_shape.h"
#include "readings/path_measures.h"
#include "readings/smoothness.h"
#include "readings/strokes.h"

namespace condyle::host {
namespace {

constexpr double kLeastHeight_m = 2e-3, kHeightShare = 0.3;
constexpr double kShortest_s = 0.25, kLongest_s = 3, kLongestGap_s = 0.1, kPause_s = 0.5,
                 kInstant_s = 0.08;
constexpr double kSearch_s = 0.08;  // around a closed instant

// Turning points of z: reversals of at least `least_m`, tops and bottoms in turn.
std::vector<std::size_t> turning_points(const std::vector<double>& z, double least_m,
                                        bool& begins_with_top) {
  std::vector<std::size_t> turns;
  std::size_t high = 0, low = 0;
  int direction = 0;  // 1: rising since the last bottom
  for (std::size_t k = 1; k < z.size(); ++k) {
    if (z[k] > z[high]) high = k;
    if (z[k] < z[low]) low = k;
    if (direction >= 0 && z[high] - z[k] >= least_m) {
      if (direction == 0) begins_with_top = true;
      turns.push_back(high);
      direction = -1;
      low = k;
    } else if (direction <= 0 && z[k] - z[low] >= least_m) {
      if (direction == 0) begins_with_top = false;
      turns.push_back(low);
      direction = 1;
      high = k;
    }
  }
  if (direction > 0) turns.push_back(high);  // the last closing has no opening after it
  return turns;
}

// Depth below the top that counts as closed.
double closed_depth_m(double height_m, double noise_sd_m) {
  return std::max({0.2e-3, 5 * noise_sd_m, 0.015 * height_m});
}

// When z, going from `from` in steps of `way`, first lies `depth_m` below `top_m`, interpolated.
double passage_s(const std::vector<double>& time_s, const std::vector<double>& z, std::size_t from,
                 int way, double level_m) {
  // Inside the closed time first: noise may have taken `from` below the level.
  std::size_t k = from;
  while (z[k] <= level_m && k > 0 && k + 1 < z.size()) k = way > 0 ? k - 1 : k + 1;
  while (true) {
    const std::size_t next = way > 0 ? k + 1 : k - 1;
    if ((way > 0 && next >= z.size()) || (way < 0 && k == 0)) return time_s[k];
    if (z[next] <= level_m && z[k] > level_m) {
      const double share = (z[k] - level_m) / (z[k] - z[next]);
      return time_s[k] + share * (time_s[next] - time_s[k]);
    }
    k = next;
  }
}

// When the departure in direction `way` from a closed jaw began, if it grows with the third power
// of time, as movements of least jerk do: the zero of that law through two depths. `last`: the last
// closed sample.
double departure_s(const std::vector<double>& time_s, const std::vector<double>& z,
                   std::size_t last, int way, double top_m, double depth_m) {
  const double t1 = passage_s(time_s, z, last, way, top_m - depth_m);
  const double t2 = passage_s(time_s, z, last, way, top_m - 4 * depth_m);
  return t1 - (t2 - t1) / (std::cbrt(4.0) - 1);
}

double percentile_90(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Time of the top of z near sample `at`: of the parabola through it and its neighbours.
double top_s(const std::vector<double>& time_s, const std::vector<double>& z, std::size_t at) {
  if (at == 0 || at + 1 >= z.size()) return time_s[at];
  const double a = time_s[at - 1] - time_s[at], b = time_s[at + 1] - time_s[at];
  const double p = z[at - 1] - z[at], q = z[at + 1] - z[at];
  const double curve = (p * b - q * a) / (a * b * (a - b));
  const double slope = (p - curve * a * a) / a;
  if (!(curve < 0)) return time_s[at];
  return time_s[at] + std::clamp(-slope / (2 * curve), a, b);
}

// Rates of the heights (m/s).
std::vector<double> height_rates_of(const JawPath& path, bool has_landmarks) {
  std::vector<double> rates;
  for (std::size_t k = 0; k < path.time_s.size(); ++k) {
    const Eigen::Vector3d& point = path.incisor_m[k];
    rates.push_back(has_landmarks || point.isZero(0)
                        ? path.incisor_m_s[k].z()
                        : -path.incisor_m_s[k].dot(point) / point.norm());
  }
  return rates;
}

// When the rate passes from negative to positive nearest to sample `at`.
double standstill_s(const std::vector<double>& time_s, const std::vector<double>& rates,
                    std::size_t at) {
  double nearest_s = time_s[at];
  double least_s = kSearch_s;
  for (std::size_t k = 1; k < rates.size(); ++k) {
    if (!(rates[k - 1] <= 0 && rates[k] > 0)) continue;
    const double share = rates[k - 1] / (rates[k - 1] - rates[k]);
    const double zero_s = time_s[k - 1] + share * (time_s[k] - time_s[k - 1]);
    if (std::abs(zero_s - time_s[at]) >= least_s) continue;
    least_s = std::abs(zero_s - time_s[at]);
    nearest_s = zero_s;
  }
  return nearest_s;
}

}  // namespace

std::vector<double> heights_of(const JawPath& path, bool has_landmarks) {
  std::vector<double> heights;
  heights.reserve(path.incisor_m.size());
  if (has_landmarks) {
    for (const auto& point : path.incisor_m) heights.push_back(point.z());
    return heights;
  }
  // Away from the reference position is down.
  for (const auto& point : path.incisor_m) heights.push_back(-point.norm());
  return heights;
}

std::vector<ChewingCycle> find_cycles(const std::vector<double>& time_s,
                                      const std::vector<double>& height_m, double noise_sd_m) {
  std::vector<ChewingCycle> cycles;
  if (height_m.size() < 5) return cycles;
  bool begins_with_top = true;
  std::vector<std::size_t> turns = turning_points(height_m, kLeastHeight_m, begins_with_top);
  std::vector<double> heights_m;
  for (std::size_t i = 1; i < turns.size(); ++i) {
    heights_m.push_back(std::abs(height_m[turns[i]] - height_m[turns[i - 1]]));
  }
  const double typical_m = percentile_90(heights_m);
  const double least_m = std::max(kLeastHeight_m, kHeightShare * typical_m);
  turns = turning_points(height_m, least_m, begins_with_top);
  if (!begins_with_top && !turns.empty()) turns.erase(turns.begin());
  for (std::size_t i = 0; i + 2 < turns.size(); i += 2) {
    ChewingCycle cycle;
    cycle.turn = turns[i + 1];
    cycle.turn_s = time_s[cycle.turn];
    const double depth_m = closed_depth_m(
        std::max(height_m[turns[i]], height_m[turns[i + 2]]) - height_m[cycle.turn], noise_sd_m);
    // The closed times before and after: all samples near the top.
    const auto closed = [&](std::size_t top, std::size_t floor, std::size_t roof) {
      std::size_t first = top, last = top;
      for (std::size_t k = top; k > floor; --k) {
        if (height_m[k] > height_m[top] - depth_m) first = k;
      }
      for (std::size_t k = top; k < roof; ++k) {
        if (height_m[k] > height_m[top] - depth_m) last = k;
      }
      return std::pair(first, last);
    };
    const std::size_t before = i == 0 ? 0 : turns[i - 1];
    const std::size_t after = i + 3 < turns.size() ? turns[i + 3] : height_m.size() - 1;
    const auto [begin_first, begin_last] = closed(turns[i], before, cycle.turn);
    const auto [end_first, end_last] = closed(turns[i + 2], cycle.turn, after);
    // Before the first cycle and after the last one, no other cycle shares the closed time.
    const bool is_last = i + 3 >= turns.size();
    cycle.begins_after_pause =
        time_s[begin_last] - time_s[begin_first] >= (i == 0 ? kInstant_s : kPause_s);
    cycle.ends_with_pause =
        time_s[end_last] - time_s[end_first] >= (is_last ? kInstant_s : kPause_s);
    cycle.begin = cycle.begins_after_pause ? begin_last : turns[i];
    cycle.end = cycle.ends_with_pause ? end_first : turns[i + 2];
    cycle.begin_s = time_s[cycle.begin];
    cycle.end_s = time_s[cycle.end];
    // A closed time between instant and pause: its middle is the boundary of both cycles.
    const auto middle = [&](std::size_t first, std::size_t last, std::size_t& at, double& at_s,
                            double& sd_s) {
      const double closed_s = time_s[last] - time_s[first];
      if (closed_s < kInstant_s || closed_s >= kPause_s) return;
      at = (first + last) / 2;
      at_s = (time_s[first] + time_s[last]) / 2;
      sd_s = 0.1 * closed_s;
    };
    if (!cycle.begins_after_pause) {
      middle(begin_first, begin_last, cycle.begin, cycle.begin_s, cycle.begin_sd_s);
    }
    if (!cycle.ends_with_pause) {
      middle(end_first, end_last, cycle.end, cycle.end_s, cycle.end_sd_s);
    }
    const double gap_s = longest_gap_s(time_s, cycle.begin, cycle.end + 1);
    const double duration_s = cycle.end_s - cycle.begin_s;
    if (gap_s > kLongestGap_s) {
      cycle.rejected = fmt::format("a gap of {:.2f} s", gap_s);
    } else if (duration_s < kShortest_s || duration_s > kLongest_s) {
      cycle.rejected = fmt::format("it lasts {:.2f} s", duration_s);
    }
    cycles.push_back(cycle);
  }
  return cycles;
}

std::vector<std::string_view> readings_of_cycle(bool has_landmarks) {
  std::vector<std::string_view> names = {"cycle_duration_s",
                                         "opening_time_s",
                                         "closing_time_s",
                                         "opening_peak_speed_mm_s",
                                         "closing_peak_speed_mm_s",
                                         "sparc",
                                         "ldlj",
                                         "closing_sparc",
                                         "closing_ldlj"};
  const auto append = [&names](const std::vector<std::string_view>& more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  append(names_of_cycle_shape());
  if (has_landmarks) {
    append({"cycle_height_mm", "cycle_width_mm", "cycle_depth_mm"});
    append(names_of_cycle_shape_with_landmarks());
  }
  return names;
}

void read_cycle(const ChewingCycle& cycle, std::size_t offset, double noise_sd_m,
                bool has_landmarks, const JawPath& path, const GreatestAt& greatest,
                std::vector<double>& values, std::vector<std::string>* why) {
  const std::vector<double> z = heights_of(path, has_landmarks);
  const auto& time_s = path.time_s;
  // The top near `at`, and when the jaw was closed there.
  const auto closed = [&](std::size_t at, bool is_pause, double sd_s, int way, std::size_t& top) {
    std::size_t first = at, last = at;
    while (first > 0 && time_s[at] - time_s[first - 1] <= kSearch_s) --first;
    while (last + 1 < z.size() && time_s[last + 1] - time_s[at] <= kSearch_s) ++last;
    top = greatest_at(z, first, last + 1);
    if (!is_pause && sd_s > 0) {
      // The middle between the passages on both sides.
      top = at;
      double top_m = z[at];
      for (std::size_t k = at; k > 0 && time_s[at] - time_s[k] < kInstant_s / 2; --k) {
        top_m = std::max(top_m, z[k]);
      }
      const double level_m = top_m - closed_depth_m(top_m - z[cycle.turn - offset], noise_sd_m);
      return (passage_s(time_s, z, at, 1, level_m) + passage_s(time_s, z, at, -1, level_m)) / 2;
    }
    if (!is_pause) return top_s(time_s, z, top);
    // The height while closed: mean of the half second on the closed side, as far as it is there.
    double sum = 0, count = 0;
    for (std::size_t k = at;; k = way > 0 ? k - 1 : k + 1) {
      sum += z[k];
      ++count;
      if (k == 0 || k + 1 == z.size() || std::abs(time_s[k] - time_s[at]) > 0.25) break;
    }
    const double top_m = sum / count;
    const double height_m = top_m - z[cycle.turn - offset];
    return departure_s(time_s, z, at, way, top_m, closed_depth_m(height_m, noise_sd_m));
  };
  std::size_t begin = 0, end = 0;
  const double begin_s =
      closed(cycle.begin - offset, cycle.begins_after_pause, cycle.begin_sd_s, 1, begin);
  const double end_s = closed(cycle.end - offset, cycle.ends_with_pause, cycle.end_sd_s, -1, end);
  begin = std::min(begin, cycle.turn - offset - 1);
  end = std::max(end, cycle.turn - offset + 1);
  std::vector<double> depths, speeds;
  depths.reserve(z.size());
  speeds.reserve(z.size());
  for (std::size_t k = 0; k < z.size(); ++k) {
    depths.push_back(-z[k]);
    speeds.push_back(path.incisor_m_s[k].norm());
  }
  const Greatest deepest = greatest.of(depths, begin, end + 1);
  const std::size_t turn = deepest.at;
  const std::vector<double> rates = height_rates_of(path, has_landmarks);
  const double turn_s = standstill_s(time_s, rates, turn);
  values = {end_s - begin_s, turn_s - begin_s, end_s - turn_s};
  double smoothness[2][2], doubts[2];
  for (int back = 0; back < 2; ++back) {
    const std::size_t from = back == 0 ? begin : turn, to = back == 0 ? turn : end;
    values.push_back(greatest.of(speeds, from, to + 1).value * 1e3);
    const Smoothness one =
        smoothness_of(time_s, speeds, back == 0 ? begin_s : turn_s, back == 0 ? turn_s : end_s);
    smoothness[back][0] = one.spectral_arc_length;
    smoothness[back][1] = one.log_dimensionless_jerk;
    doubts[back] = one.arc_length_doubt;
  }
  for (const auto& phase : smoothness) values.insert(values.end(), phase, phase + 2);
  if (why != nullptr) why->assign(values.size(), "");
  const CycleMarks marks{begin, turn, end, begin_s, end_s, cycle.ends_with_pause};
  const CycleIntegrals integrals = integrals_of(marks, path);
  add_cycle_shape(marks, path, integrals, z, rates, greatest, values, why);
  if (has_landmarks) {
    values.push_back((greatest.of(z, begin, end + 1).value + deepest.value) * 1e3);
    if (why != nullptr) why->emplace_back();
    for (const int axis : {1, 0}) {
      double range = 0;
      for (const double sign : {1.0, -1.0}) {
        for (std::size_t k = 0; k < z.size(); ++k) depths[k] = sign * path.incisor_m[k][axis];
        range += greatest.of(depths, begin, end + 1).value;
      }
      values.push_back(range * 1e3);
      if (why != nullptr) why->emplace_back();
    }
    add_cycle_shape_with_landmarks(marks, path, integrals, greatest, values, why);
    values.push_back(begin_s - cycle.begin_s);
    if (why != nullptr) why->emplace_back();
  }
  values.insert(values.end(), doubts, doubts + 2);
  if (why != nullptr) why->resize(values.size());
}

}  // namespace condyle::host
