// SPDX-License-Identifier: Apache-2.0
#include "readings/strokes.h"

#include <algorithm>
#include <cmath>

#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr double kLeastRest_s = 0.3, kRestSpeed_m_s = 2e-3, kClosed_m = 0.5e-3;
constexpr double kSpeedWindow_s = 0.1, kLongestSpeedWindow_s = 0.5, kRestMargin_s = 0.25;

struct Rest {
  SampleRun run;
  double height_m;
};

// A window over which means show a speed in spite of the noise of the places, which their second
// differences show.
double speed_window_s(const PoseTrack& track) {
  constexpr double median_of_chi3 = 1.538;  // times sqrt(6): of a second difference
  std::vector<double> sizes_m;
  for (std::size_t k = 1; k + 1 < track.pose.size(); ++k) {
    sizes_m.push_back((track.pose[k - 1].translation() - 2 * track.pose[k].translation() +
                       track.pose[k + 1].translation())
                          .norm());
  }
  const double noise_m = upper_median(std::move(sizes_m)) / (median_of_chi3 * std::sqrt(6.0));
  const double rate_Hz =
      static_cast<double>(track.time_s.size() - 1) / (track.time_s.back() - track.time_s.front());
  double window_s = kSpeedWindow_s;
  while (window_s < kLongestSpeedWindow_s &&
         noise_m * std::sqrt(6 / (rate_Hz * window_s)) > 0.4 * kRestSpeed_m_s * window_s) {
    window_s *= 1.1;
  }
  return window_s;
}

// Without the slow beginning and end of the neighbouring movements.
SampleRun inner_part(const std::vector<double>& time_s, SampleRun run) {
  const double begin_s = time_s[run.begin], end_s = time_s[run.end - 1];
  const double margin_s = std::min(kRestMargin_s, (end_s - begin_s) / 4);
  while (time_s[run.begin] < begin_s + margin_s) ++run.begin;
  while (time_s[run.end - 1] > end_s - margin_s) --run.end;
  return run;
}

}  // namespace

std::vector<SampleRun> find_rests(const PoseTrack& track) {
  const auto& time_s = track.time_s;
  const std::size_t count = time_s.size();
  // Still: the mean place before and the mean place after differ little.
  std::vector<Eigen::Vector3d> sums(count + 1, Eigen::Vector3d::Zero());
  const Eigen::Vector3d origin = track.pose[0].translation();
  for (std::size_t k = 0; k < count; ++k) {
    sums[k + 1] = sums[k] + track.pose[k].translation() - origin;
  }
  const double window_s = speed_window_s(track);
  std::vector<bool> still(count, false);
  std::size_t before = 0, after = 0;
  for (std::size_t k = 0; k < count; ++k) {
    while (time_s[k] - time_s[before] > window_s) ++before;
    while (after < count && time_s[after] - time_s[k] <= window_s) ++after;
    if (k == before || after == k + 1) continue;
    const Eigen::Vector3d earlier = (sums[k] - sums[before]) / static_cast<double>(k - before);
    const Eigen::Vector3d later = (sums[after] - sums[k + 1]) / static_cast<double>(after - k - 1);
    const double apart_s = (time_s[after - 1] - time_s[before]) / 2;
    still[k] = (later - earlier).norm() < kRestSpeed_m_s * apart_s + 1e-5;
  }
  std::vector<SampleRun> rests;
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin;
    while (end < count && still[end]) ++end;
    if (end > begin && time_s[end - 1] - time_s[begin] >= kLeastRest_s) {
      rests.push_back(inner_part(time_s, {begin, end}));
    }
    begin = end + 1;
  }
  return rests;
}

std::optional<SampleRun> find_rest(const PoseTrack& track, const Eigen::Vector3d& up) {
  const auto& time_s = track.time_s;
  std::vector<Rest> rests;
  for (const SampleRun& run : find_rests(track)) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t k = run.begin; k < run.end; ++k) mean += track.pose[k].translation();
    rests.push_back({run, mean.dot(up) / static_cast<double>(run.end - run.begin)});
  }
  if (rests.empty()) return std::nullopt;
  if (up.isZero(0)) return rests[0].run;
  double highest_m = rests[0].height_m;
  for (const Rest& rest : rests) highest_m = std::max(highest_m, rest.height_m);
  std::optional<SampleRun> longest;
  for (const Rest& rest : rests) {
    if (rest.height_m < highest_m - kClosed_m) continue;
    const auto length_s = [&](const SampleRun& run) {
      return time_s[run.end - 1] - time_s[run.begin];
    };
    if (!longest || length_s(rest.run) > length_s(*longest)) longest = rest.run;
  }
  return longest;
}

// Excursions above `high_m`, out to where they are below `near_m`.
static std::vector<SampleRun> excursions(const std::vector<double>& distance_m, std::size_t begin,
                                         std::size_t end, double high_m, double near_m) {
  std::vector<SampleRun> strokes;
  for (std::size_t k = begin; k < end; ++k) {
    if (distance_m[k] < high_m) continue;
    std::size_t first = k, last = k;
    const std::size_t floor = strokes.empty() ? begin : strokes.back().end - 1;
    while (first > floor && distance_m[first] > near_m) --first;
    while (last + 1 < end && distance_m[last] > near_m) ++last;
    // On to where the jaw stands still or turns round.
    while (first > floor && distance_m[first - 1] < distance_m[first]) --first;
    while (last + 1 < end && distance_m[last + 1] < distance_m[last]) ++last;
    strokes.push_back({first, last + 1});
    k = last + 1;
  }
  return strokes;
}

std::vector<SampleRun> find_strokes(const std::vector<double>& distance_m, std::size_t begin,
                                    std::size_t end, double least_m) {
  if (end < begin + 5) return {};
  const double greatest_m =
      *std::max_element(distance_m.begin() + static_cast<std::ptrdiff_t>(begin),
                        distance_m.begin() + static_cast<std::ptrdiff_t>(end));
  if (greatest_m < least_m) return {};
  const double high_m = std::max(least_m, 0.4 * greatest_m);
  return excursions(distance_m, begin, end, high_m, 0.25 * high_m);
}

std::vector<SampleRun> find_strokes_alone(const std::vector<double>& distance_m, std::size_t begin,
                                          std::size_t end, double least_m) {
  if (end < begin + 5) return {};
  return excursions(distance_m, begin, end, least_m, 0.5 * least_m);
}

std::optional<TaskKind> kind_of_stroke(const Eigen::Vector3d& turn_m) {
  const double x = turn_m.x() * 1e3, y = turn_m.y() * 1e3, z = turn_m.z() * 1e3;
  if (-z > 2 * std::max(std::abs(y), x + 3)) return TaskKind::opening;
  if (std::abs(y) > 2 && std::abs(y) > std::abs(z) / 2 && std::abs(y) > std::abs(x)) {
    return y > 0 ? TaskKind::left : TaskKind::right;
  }
  if (x > 2 && std::abs(y) < x / 3) return TaskKind::protrusion;
  return std::nullopt;
}

double longest_gap_s(const std::vector<double>& time_s, std::size_t begin, std::size_t end) {
  double gap_s = 0;
  for (std::size_t k = begin + 1; k < end; ++k) gap_s = std::max(gap_s, time_s[k] - time_s[k - 1]);
  return gap_s;
}

double longest_drawn_gap_s(const std::vector<double>& time_s) {
  constexpr double kGap_s = 0.1, kSteps = 3.5;
  std::vector<double> steps_s;
  for (std::size_t k = 1; k < time_s.size(); ++k) steps_s.push_back(time_s[k] - time_s[k - 1]);
  if (steps_s.empty()) return kGap_s;
  return std::max(kGap_s, kSteps * upper_median(std::move(steps_s)));
}

std::vector<SampleRun> runs_without_gap(const std::vector<double>& time_s, SampleRun run,
                                        double gap_s) {
  std::vector<SampleRun> runs;
  for (std::size_t k = run.begin; k < run.end; ++k) {
    // Times are known to about a nanosecond.
    const bool is_after_gap = k > run.begin && time_s[k] - time_s[k - 1] > gap_s + 1e-9;
    if (k == run.begin || is_after_gap) runs.push_back({k, k});
    runs.back().end = k + 1;
  }
  return runs;
}

}  // namespace condyle::host
