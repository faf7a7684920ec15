// SPDX-License-Identifier: Apache-2.0
#include "readings/burst_search.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

namespace condyle::host {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kLongestBurst_s = 0.2, kLeastDeparture_m = 3e-4;
constexpr std::size_t kSide = 4, kNeighbours = 20;
constexpr std::size_t kLeastFrozen = 5;
constexpr double kJumpRatio = 6, kMisfitRatio = 5;
constexpr double kMostBend = 0.5;  // of the longest step, in a movement

// How far sample k + 1 departs from the straight line through k - 1 and k.
double bend(const std::vector<double>& time_s, const std::vector<Vector6>& path, std::size_t k) {
  const double before_s = time_s[k] - time_s[k - 1], after_s = time_s[k + 1] - time_s[k];
  return (path[k + 1] - path[k] - (path[k] - path[k - 1]) * (after_s / before_s)).norm();
}

// The samples of `begin` to `end` (without) that lie far from the cubic through the samples on both
// sides, and its misfit there; none unless the first and the last do. `before`: the last good
// samples before `begin`, the latest last.
struct Departure {
  std::vector<std::size_t> far;
  double misfit_m = 0;
};

Departure departure_of(const std::vector<double>& time_s, const std::vector<Vector6>& path,
                       const std::array<std::size_t, kSide>& before, std::size_t begin,
                       std::size_t end) {
  constexpr int rows = 2 * kSide;
  const double middle_s = (time_s[begin] + time_s[end - 1]) / 2;
  const double scale_s = (time_s[end + kSide - 1] - time_s[before[0]]) / 2;
  const auto powers = [&](std::size_t k) {
    const double x = (time_s[k] - middle_s) / scale_s;
    return Eigen::RowVector4d(1, x, x * x, x * x * x);
  };
  Eigen::Matrix<double, rows, 4> A;
  Eigen::Matrix<double, rows, 6> y;
  for (std::size_t i = 0; i < kSide; ++i) {
    for (const auto& [row, k] : {std::pair(i, before[i]), std::pair(kSide + i, end + i)}) {
      A.row(static_cast<int>(row)) = powers(k);
      y.row(static_cast<int>(row)) = path[k].transpose();
    }
  }
  const Eigen::Matrix<double, 4, 6> cubic = A.householderQr().solve(y);
  Departure departure;
  departure.misfit_m = std::sqrt((A * cubic - y).squaredNorm() / (rows - 4));
  const double limit_m = std::max(kMisfitRatio * departure.misfit_m, kLeastDeparture_m);
  std::vector<std::size_t>& far = departure.far;
  for (std::size_t k = begin; k < end; ++k) {
    if ((powers(k) * cubic - path[k].transpose()).norm() >= limit_m) far.push_back(k);
  }
  if (far.empty() || far.front() != begin || far.back() + 1 != end) far.clear();
  return departure;
}

// Whether the path goes to the samples `far` and comes back by steps that grow and shrink, as a
// fast movement does: a jump bends it by as much as its longest step.
bool is_movement(const std::vector<double>& bends, const std::vector<Vector6>& path,
                 const std::vector<std::size_t>& far) {
  const std::size_t begin = far.front(), end = far.back() + 1;
  if (end - begin != far.size() || end >= path.size()) return false;
  double bend_m = 0, step_m = 0;
  for (std::size_t k = begin - 1; k <= end; ++k) bend_m = std::max(bend_m, bends[k]);
  for (std::size_t k = begin; k <= end; ++k) {
    step_m = std::max(step_m, (path[k] - path[k - 1]).norm());
  }
  return bend_m <= kMostBend * step_m;
}

}  // namespace

std::vector<SampleRun> find_bursts(const std::vector<double>& time_s,
                                   const std::vector<Vector6>& path) {
  std::vector<SampleRun> runs;
  if (path.size() < 2 * kSide + 1) return runs;
  std::vector<double> bends(path.size(), 0);
  for (std::size_t k = 1; k + 1 < path.size(); ++k) bends[k] = bend(time_s, path, k);
  std::vector<bool> is_bad(path.size(), false);
  for (std::size_t begin = kSide; begin + kSide < path.size(); ++begin) {
    const double jump_m = bends[begin - 1];
    if (jump_m < kLeastDeparture_m) continue;
    const std::size_t from = begin > kNeighbours ? begin - kNeighbours : 1;
    const std::size_t to = std::min(begin + kNeighbours, path.size() - 1);
    // The jump is that many times their median exactly if it is so for more than half of them.
    const auto at = bends.begin();
    const auto smaller =
        std::count_if(at + static_cast<std::ptrdiff_t>(from), at + static_cast<std::ptrdiff_t>(to),
                      [jump_m](double bend_m) { return kJumpRatio * bend_m <= jump_m; });
    if (static_cast<std::size_t>(smaller) <= (to - from) / 2) continue;
    std::array<std::size_t, kSide> before{};
    std::size_t found = 0;
    for (std::size_t k = begin; k > 0 && found < kSide; --k) {
      if (!is_bad[k - 1]) before[kSide - ++found] = k - 1;
    }
    if (found < kSide) continue;
    // Of all possible ends the first, unless the sides of another fit far better: a second spike
    // may stand among them.
    Departure best;
    for (std::size_t end = begin + 1; end + kSide <= path.size(); ++end) {
      if (time_s[end - 1] - time_s[begin] > kLongestBurst_s) break;
      const Departure departure = departure_of(time_s, path, before, begin, end);
      if (departure.far.empty()) continue;
      if (best.far.empty() || departure.misfit_m < 0.2 * best.misfit_m) {
        best = departure;
      }
    }
    if (best.far.empty()) continue;
    const bool is_fast = is_movement(bends, path, best.far);
    for (const std::size_t k : best.far) {
      if (is_fast) break;
      is_bad[k] = true;
      if (!runs.empty() && runs.back().end == k) {
        ++runs.back().end;
      } else {
        runs.push_back({k, k + 1});
      }
    }
    begin = best.far.back() + 1;  // the way back is a jump too
  }
  return runs;
}

std::vector<SampleRun> find_frozen(const std::vector<Vector6>& path) {
  std::vector<SampleRun> runs;
  for (std::size_t begin = 0; begin < path.size();) {
    std::size_t end = begin + 1;
    while (end < path.size() && path[end] == path[begin]) ++end;
    const bool jumps = end < path.size() && (path[end] - path[begin]).norm() > kLeastDeparture_m;
    if (end - begin >= kLeastFrozen && jumps) runs.push_back({begin + 1, end});
    begin = end;
  }
  return runs;
}

}  // namespace condyle::host
