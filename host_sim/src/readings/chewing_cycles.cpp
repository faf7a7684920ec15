// SPDX-License-Identifier: Apache-2.0
#include "readings/chewing_cycles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "readings/closed_times.h"
#include "readings/cycle_shape.h"
#include "readings/path_measures.h"
#include "readings/smoothness.h"
#include "readings/strokes.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr double kLeastHeight_m = 2e-3, kHeightShare = 0.3;
constexpr double kShortest_s = 0.25, kLongest_s = 3, kLongestGap_s = 0.1, kPause_s = 0.5,
                 kInstant_s = 0.08;
constexpr double kSearch_s = 0.08;   // around a closed instant
constexpr double kPartingNoise = 4;  // standard deviations of a rise between two openings
constexpr double kTimesUsual = 2;    // a pause, over the median closed time
// Standard deviation of the middle of a closed time, over that time and what two laws differ by.
constexpr double kShareOfClosed = 0.075;

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

namespace {

// The turning points of cycles within the window: top, bottom, top, ...
std::vector<std::size_t> turns_of_cycles(const std::vector<double>& z, SampleRun window) {
  const std::vector<double> inside(z.begin() + static_cast<std::ptrdiff_t>(window.begin),
                                   z.begin() + static_cast<std::ptrdiff_t>(window.end));
  bool begins_with_top = true;
  std::vector<std::size_t> turns = turning_points(inside, kLeastHeight_m, begins_with_top);
  std::vector<double> heights_m;
  for (std::size_t i = 1; i < turns.size(); ++i) {
    heights_m.push_back(std::abs(inside[turns[i]] - inside[turns[i - 1]]));
  }
  const double usual_m = heights_m.empty() ? 0 : sorted_at(heights_m, heights_m.size() * 9 / 10);
  const double least_m = std::max(kLeastHeight_m, kHeightShare * usual_m);
  turns = turning_points(inside, least_m, begins_with_top);
  if (!begins_with_top && !turns.empty()) turns.erase(turns.begin());
  for (std::size_t& turn : turns) turn += window.begin;
  return turns;
}

}  // namespace

std::vector<ChewingCycle> find_cycles(const std::vector<double>& time_s,
                                      const std::vector<double>& height_m, double noise_sd_m,
                                      SampleRun window) {
  std::vector<ChewingCycle> cycles;
  if (window.end < window.begin + 5) return cycles;
  const std::vector<std::size_t> turns = turns_of_cycles(height_m, window);
  const ClosedTimes closed_times(time_s, height_m, window, kLongestGap_s);
  const auto depth_at = [&](std::size_t i) {
    return closed_depth_m(
        std::max(height_m[turns[i - 1]], height_m[turns[i + 1]]) - height_m[turns[i]], noise_sd_m);
  };
  const auto closed_at = [&](std::size_t i, double depth_m) {
    return closed_times.around(turns[i], i == 0 ? window.begin : turns[i - 1],
                               i + 1 < turns.size() ? turns[i + 1] : window.end, depth_m);
  };
  // Who is closed as long after each cycle does not pause.
  std::vector<double> lengths_s;
  for (std::size_t i = 2; i + 2 < turns.size(); i += 2) {
    lengths_s.push_back(closed_times.length_s(closed_at(i, depth_at(i + 1))));
  }
  const double usual_s = lengths_s.empty() ? 0 : upper_median(std::move(lengths_s));
  const double pause_s = std::max(kPause_s, kTimesUsual * usual_s);
  for (std::size_t i = 0; i + 2 < turns.size(); i += 2) {
    ChewingCycle cycle;
    cycle.turn = turns[i + 1];
    cycle.turn_s = time_s[cycle.turn];
    const double depth_m = depth_at(i + 1);
    const ClosedTime begin = closed_at(i, depth_m), end = closed_at(i + 2, depth_m);
    // What the recording does not show is taken as closed.
    const auto is_pause = [&](const ClosedTime& closed) {
      return closed_times.length_s(closed) >= (closed.is_cut ? kInstant_s : pause_s);
    };
    const auto is_partial = [&](const ClosedTime& closed, std::size_t at) {
      const bool is_outside = at < window.begin || at >= window.end;
      return closed.is_in_cycle || (!is_pause(closed) && (closed.is_cut || is_outside));
    };
    cycle.open_s = time_s[end.first] - time_s[begin.last];
    const auto doubt_s = [&](const ClosedTime& closed, std::size_t at, int way) {
      const double top_m = height_m[closed.top];
      return departure_doubt_s(time_s, height_m, at, way, top_m, depth_m,
                               top_m - height_m[cycle.turn]);
    };
    // The edge that `closed` gives; `way`: from it into the cycle.
    const auto edge_of = [&](const ClosedTime& closed, int way, std::size_t& at, double& at_s) {
      const double top_m = height_m[closed.top], closed_s = closed_times.length_s(closed);
      const std::size_t near = way > 0 ? closed.last : closed.first;
      const std::size_t far = way > 0 ? closed.first : closed.last;
      CycleEdge edge;
      edge.is_pause = is_pause(closed);
      at = edge.is_pause ? near : closed.top;
      at_s = edge.reads_s = time_s[at];
      if (edge.is_pause) {
        edge.sd_s = doubt_s(closed, near, way);
      } else if (closed_s >= kInstant_s) {
        // Between instant and pause: its middle is the edge of both cycles.
        at = (closed.first + closed.last) / 2;
        const double of_laws_s =
            doubt_s(closed, closed.first, -1) + doubt_s(closed, closed.last, 1);
        edge.is_slow = of_laws_s > closed_s;
        at_s = middle_of_closed_s(time_s, height_m, at, top_m, depth_m, edge.is_slow);
        edge.sd_s = kShareOfClosed * (closed_s + std::min(of_laws_s, 3 * closed_s));
        const double reaches_s =
            passage_s(time_s, height_m, far, -way, top_m - kDepthsOfLaw * depth_m);
        edge.reads_s = time_s[far] + std::clamp(reaches_s - time_s[far], -closed_s, closed_s);
      }
      return edge;
    };
    cycle.begins = edge_of(begin, 1, cycle.begin, cycle.begin_s);
    cycle.ends = edge_of(end, -1, cycle.end, cycle.end_s);
    const double gap_s = longest_gap_s(time_s, cycle.begin, cycle.end + 1);
    const double duration_s = cycle.end_s - cycle.begin_s;
    if (gap_s > kLongestGap_s) {
      cycle.rejected = fmt::format("a gap of {:.2f} s", gap_s);
    } else if (is_partial(begin, cycle.begin)) {
      cycle.rejected = "the task or the recording begins within it";
    } else if (is_partial(end, cycle.end)) {
      cycle.rejected = "the task or the recording ends within it";
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

namespace {

// The deepest place from `begin` to `end` (without). If a rise parts two, the deeper one: means
// over 60 ms would prefer the wider.
Greatest deepest_of(const std::vector<double>& time_s, const std::vector<double>& depths_m,
                    std::size_t begin, std::size_t end, double noise_sd_m,
                    const GreatestAt& greatest) {
  const Greatest deepest = greatest.of(depths_m, begin, end);
  const std::size_t top = greatest_at(depths_m, begin, end);
  if (std::abs(time_s[top] - deepest.time_s) <= kCycleTopReach_s) return deepest;
  const auto at = [&](std::size_t k) { return depths_m.begin() + static_cast<std::ptrdiff_t>(k); };
  const auto rise = std::min_element(at(std::min(top, deepest.at)), at(std::max(top, deepest.at)));
  if (deepest.value - *rise < kPartingNoise * noise_sd_m) return deepest;
  const auto parting = static_cast<std::size_t>(rise - depths_m.begin());
  const Greatest other = top < deepest.at ? greatest.of(depths_m, begin, parting + 1)
                                          : greatest.of(depths_m, parting, end);
  return other.value > deepest.value ? other : deepest;
}

}  // namespace

void read_cycle(const ChewingCycle& cycle, std::size_t offset, double noise_sd_m,
                bool has_landmarks, const JawPath& path, const GreatestAt& greatest,
                std::vector<double>& values, std::vector<std::string>* why) {
  const std::vector<double> z = heights_of(path, has_landmarks);
  const auto& time_s = path.time_s;
  // The top near `at`, and when the jaw was closed there.
  const auto closed = [&](std::size_t at, const CycleEdge& edge, int way, std::size_t& top) {
    std::size_t first = at, last = at;
    while (first > 0 && time_s[at] - time_s[first - 1] <= kSearch_s) --first;
    while (last + 1 < z.size() && time_s[last + 1] - time_s[at] <= kSearch_s) ++last;
    top = greatest_at(z, first, last + 1);
    if (!edge.is_pause && edge.sd_s > 0) {
      top = at;
      double top_m = z[at];
      for (std::size_t k = first; k <= last; ++k) {
        if (std::abs(time_s[k] - time_s[at]) < kInstant_s / 2) top_m = std::max(top_m, z[k]);
      }
      const double depth_m = closed_depth_m(top_m - z[cycle.turn - offset], noise_sd_m);
      return middle_of_closed_s(time_s, z, at, top_m, depth_m, edge.is_slow);
    }
    if (!edge.is_pause) return top_s(time_s, z, top);
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
  const double begin_s = closed(cycle.begin - offset, cycle.begins, 1, begin);
  const double end_s = closed(cycle.end - offset, cycle.ends, -1, end);
  begin = std::min(begin, cycle.turn - offset - 1);
  end = std::max(end, cycle.turn - offset + 1);
  std::vector<double> depths, speeds;
  depths.reserve(z.size());
  speeds.reserve(z.size());
  for (std::size_t k = 0; k < z.size(); ++k) {
    depths.push_back(-z[k]);
    speeds.push_back(path.incisor_m_s[k].norm());
  }
  const Greatest deepest = deepest_of(time_s, depths, begin, end + 1, noise_sd_m, greatest);
  const std::size_t turn = deepest.at;
  const std::vector<double> rates = height_rates_of(path, has_landmarks);
  const double turn_s = standstill_s(time_s, rates, turn);
  values = {end_s - begin_s, turn_s - begin_s, end_s - turn_s};
  double smoothness[2][2], doubts[2];
  std::vector<double> shortfalls;  // m
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
  const CycleMarks marks{begin, turn, end, begin_s, end_s, cycle.ends.is_pause};
  const CycleIntegrals integrals = integrals_of(marks, path);
  add_cycle_shape(marks, path, integrals, z, rates, greatest, values, why);
  if (has_landmarks) {
    const Greatest highest = greatest.of(z, begin, end + 1);
    values.push_back((highest.value + deepest.value) * 1e3);
    shortfalls.push_back(shortfall_of(highest) + shortfall_of(deepest));
    if (why != nullptr) why->emplace_back();
    for (const int axis : {1, 0}) {
      double range = 0, shortfall = 0;
      for (const double sign : {1.0, -1.0}) {
        for (std::size_t k = 0; k < z.size(); ++k) depths[k] = sign * path.incisor_m[k][axis];
        const Greatest top = greatest.of(depths, begin, end + 1);
        range += top.value;
        shortfall += shortfall_of(top);
      }
      values.push_back(range * 1e3);
      shortfalls.push_back(shortfall);
      if (why != nullptr) why->emplace_back();
    }
    add_cycle_shape_with_landmarks(marks, path, integrals, greatest, values, why);
    values.push_back(begin_s - cycle.begin_s);
    if (why != nullptr) why->emplace_back();
  }
  values.insert(values.end(), doubts, doubts + 2);
  for (const double shortfall_m : shortfalls) values.push_back(shortfall_m * 1e3);
  if (why != nullptr) why->resize(values.size());
}

}  // namespace condyle::host
