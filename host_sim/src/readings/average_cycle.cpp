// SPDX-License-Identifier: Apache-2.0
#include "readings/average_cycle.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "readings/analysis.h"
#include "readings/uncertainty.h"
#include "statistics/chi_square.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr int kPoints = 2 * AverageCycle::kHalf;
constexpr int kLeastCycles = 5;
constexpr double kWidest_mm = 3;

// At one instant: the incisor, and the motion that the shared errors act on.
struct Instant {
  Vector3d incisor_m;
  Vector6 motion;
};

// The path between samples: of the incisor a cubic, of the motion a line. The search begins at
// sample `k` and leaves there the last one before the instant.
Instant instant_at(const JawPath& path, double time_s, std::size_t& k) {
  const auto& times = path.time_s;
  k = std::min(k, times.size() - 2);
  while (k > 0 && times[k] > time_s) --k;
  while (k + 2 < times.size() && times[k + 1] <= time_s) ++k;
  const double step_s = times[k + 1] - times[k];
  const double x = std::clamp((time_s - times[k]) / step_s, 0.0, 1.0), y = 1 - x;
  Instant instant;
  instant.incisor_m = y * y * (1 + 2 * x) * path.incisor_m[k] +
                      x * x * (1 + 2 * y) * path.incisor_m[k + 1] +
                      x * y * step_s * (y * path.incisor_m_s[k] - x * path.incisor_m_s[k + 1]);
  instant.motion << y * path.middle_m[k] + x * path.middle_m[k + 1],
      y * path.rotation_rad[k] + x * path.rotation_rad[k + 1];
  return instant;
}

double share_of(int point) {
  return static_cast<double>(point % AverageCycle::kHalf) / (AverageCycle::kHalf - 1);
}

// Closed, most open, closed: between samples (s).
std::array<double, 3> times_of(const AnalysedCycle& cycle) {
  const double shift_s = cycle.directions.begin_shift_s.value;
  const double begin_s = cycle.cycle.begin_s + (std::isfinite(shift_s) ? shift_s : 0);
  return {begin_s, begin_s + cycle.values[1].value, begin_s + cycle.values[0].value};
}

// Squares of what the shared errors change in the mean path (mm2).
std::vector<Vector3d> shared_squares(const std::vector<Vector6>& motion,
                                     const SharedErrors& errors) {
  SmoothMotion mean;
  mean.value = motion;
  mean.slope.assign(motion.size(), Vector6::Zero());
  for (std::size_t k = 0; k < motion.size(); ++k) mean.time_s.push_back(static_cast<double>(k));
  JawPath right, off;
  paths_of(mean, errors.geometry, right);
  std::vector<Vector3d> squares(motion.size(), Vector3d::Zero());
  for (const ReadingGeometry& moved : errors.off_by_one_sd) {
    paths_of(mean, moved, off);
    for (std::size_t k = 0; k < squares.size(); ++k) {
      squares[k] += 1e6 * (off.incisor_m[k] - right.incisor_m[k]).cwiseAbs2();
    }
  }
  return squares;
}

AverageCycle average_of(const JawPath& path, const std::vector<const AnalysedCycle*>& cycles,
                        const std::string& side, const SharedErrors& errors) {
  AverageCycle average;
  average.side = side;
  average.cycles = static_cast<int>(cycles.size());
  if (average.cycles < kLeastCycles) {
    average.withheld =
        fmt::format("{} cycles, at least {} are needed", average.cycles, kLeastCycles);
    return average;
  }
  const double count = average.cycles;
  std::vector<Vector3d> sums(kPoints, Vector3d::Zero()), squares(kPoints, Vector3d::Zero());
  std::vector<Vector6> motion(kPoints, Vector6::Zero());
  std::vector<std::vector<Vector3d>> points(kPoints);
  for (auto& of_all : points) of_all.reserve(cycles.size());
  for (const AnalysedCycle* cycle : cycles) {
    const auto [begin_s, turn_s, end_s] = times_of(*cycle);
    average.opening_s += (turn_s - begin_s) / count;
    average.closing_s += (end_s - turn_s) / count;
    if (average.assumed.empty()) average.assumed = cycle->assumed;
    std::size_t near = cycle->cycle.begin;
    for (int i = 0; i < kPoints; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const bool is_closing = i >= AverageCycle::kHalf;
      const double from_s = is_closing ? turn_s : begin_s, to_s = is_closing ? end_s : turn_s;
      const Instant instant = instant_at(path, from_s + share_of(i) * (to_s - from_s), near);
      points[k].push_back(1e3 * instant.incisor_m);
      sums[k] += points[k].back() / count;
      motion[k] += instant.motion / count;
    }
  }
  const double t = student_t_quantile(0.975, count - 1);
  const std::vector<Vector3d> shared = shared_squares(motion, errors);
  double widest_mm = 0;
  for (int i = 0; i < kPoints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (const Vector3d& point : points[k]) squares[k] += (point - sums[k]).cwiseAbs2();
    const Vector3d variance = squares[k] / (count - 1);
    const Vector3d half = (t * t / count * variance + kHalf95 * kHalf95 * shared[k]).cwiseSqrt();
    const bool is_closing = i >= AverageCycle::kHalf;
    const double time_s = is_closing ? average.opening_s + share_of(i) * average.closing_s
                                     : share_of(i) * average.opening_s;
    average.points.push_back(
        {is_closing, share_of(i), time_s, sums[k], variance.cwiseSqrt(), half});
    widest_mm = std::max(widest_mm, half.maxCoeff());
  }
  if (widest_mm > kWidest_mm) {
    average.points.clear();
    average.withheld = fmt::format("the interval would be +-{:.1f} mm, the limit is +-{:g} mm",
                                   widest_mm, kWidest_mm);
  }
  return average;
}

}  // namespace

std::vector<AverageCycle> average_cycles(const JawPath& path,
                                         const std::vector<AnalysedCycle>& cycles,
                                         const SharedErrors& errors) {
  std::vector<AverageCycle> averages;
  for (const char* side : {"all", "left", "right", "midline"}) {
    std::vector<const AnalysedCycle*> chosen;
    for (const AnalysedCycle& cycle : cycles) {
      const bool is_timed = cycle.number > 0 && std::isfinite(cycle.values[0].value) &&
                            std::isfinite(cycle.values[1].value);
      if (is_timed && (cycle.side == side || *side == 'a')) chosen.push_back(&cycle);
    }
    if (!chosen.empty()) averages.push_back(average_of(path, chosen, side, errors));
  }
  return averages;
}

}  // namespace condyle::host
