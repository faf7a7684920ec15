// SPDX-License-Identifier: Apache-2.0
#include "real_motion/reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "real_motion/order_statistics.h"
#include "real_motion/smoothing_spline.h"

namespace condyle::testing_support {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kScale = 1.4826;  // standard deviation over median of |normal|
constexpr std::size_t kShortest = 30, kEnd = 4;

// The step of a recorded grid; 0 where there is none.
double recorded_step(Values y) {
  std::erase_if(y, [](double value) { return !std::isfinite(value); });
  std::sort(y.begin(), y.end());
  Values gaps;
  std::size_t levels = y.empty() ? 0 : 1;
  for (std::size_t i = 1; i < y.size(); ++i) {
    const double gap = y[i] - y[i - 1];
    if (gap > 0) ++levels;
    if (gap > 1e-12) gaps.push_back(gap);
  }
  if (levels < 4 || gaps.empty()) return 0;
  const double step = quantile(gaps, 0.05);
  const auto on_grid = std::count_if(gaps.begin(), gaps.end(), [step](double gap) {
    return std::abs(gap / step - std::nearbyint(gap / step)) < 0.05;
  });
  const bool is_grid = static_cast<double>(on_grid) > 0.95 * static_cast<double>(gaps.size());
  return is_grid && step > 2e-7 ? step : 0;
}

struct Regularity {
  Marks is_irregular, is_smooth;
};

Regularity judge(const Values& y, double step) {
  const std::size_t n = y.size();
  Values e(n, kNone), not_zero;
  for (std::size_t i = 2; i + 2 < n; ++i) {
    e[i] = std::abs(y[i] - (4 * (y[i - 1] + y[i + 1]) - y[i - 2] - y[i + 2]) / 6);
    if (e[i] > 0) not_zero.push_back(e[i]);
  }
  const double typical = not_zero.empty() ? 0 : kScale * median(not_zero);
  const double floor = std::max({0.25 * typical, 0.6 * step, 1e-7});
  Regularity result{Marks(n, false), Marks(n, false)};
  for (std::size_t i = 2; i + 2 < n; ++i) {
    Values around;
    for (std::size_t j = i < 25 ? 0 : i - 25; j < std::min(i + 26, n); ++j) {
      if (std::isfinite(e[j])) around.push_back(e[j]);
    }
    const double s = around.size() < 10 ? floor : std::max(kScale * median(around), floor);
    result.is_irregular[i] = e[i] > 8 * s;
    result.is_smooth[i] = e[i] <= 4 * s;
  }
  return result;
}

}  // namespace

Marks to_double(const Marks& marks, std::size_t reach) {
  Marks wide(marks.size(), false);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (!marks[i]) continue;
    const std::size_t end = std::min(i + reach + 1, marks.size());
    for (std::size_t j = i < reach ? 0 : i - reach; j < end; ++j) wide[j] = true;
  }
  return wide;
}

ReferenceMotion reference_motion(const TreatedRecording& treated, std::size_t axis) {
  const MotionRecording& clean = treated.clean;
  const Values& y = clean.position_m[axis];
  const std::size_t n = y.size();
  const double T = clean.step_s(), step = recorded_step(y);
  const auto [is_irregular, is_smooth] = judge(y, step);
  const Marks is_near = to_double(is_irregular, 2);
  ReferenceMotion motion;
  motion.is_irregular = is_irregular;
  Marks is_usable(n);
  for (std::size_t i = 0; i < n; ++i) {
    is_usable[i] = clean.is_measured(i) && !is_near[i];
    motion.is_valid.push_back(is_usable[i] && is_smooth[i]);
    motion.is_measured.push_back(treated.recording.is_measured(i));
  }

  motion.velocity_m_s.assign(n, kNone);
  motion.velocity_sd_m_s.assign(n, kNone);
  double square_sum = 0, samples = 0;
  for (std::size_t first = 0, end = 0; first < n; first = std::max(end, first + 1)) {
    end = first;
    while (end < n && is_usable[end] &&
           (end == first || clean.time_s[end] - clean.time_s[end - 1] < 1.5 * T)) {
      ++end;
    }
    if (end - first < kShortest) continue;
    const auto at = [&y](std::size_t i) { return y.begin() + static_cast<std::ptrdiff_t>(i); };
    const SplineVelocity spline = fit_smoothing_spline({at(first), at(end)}, T);
    for (std::size_t i = first + kEnd; i + kEnd < end; ++i) {
      motion.velocity_m_s[i] = spline.velocity[i - first];
      motion.velocity_sd_m_s[i] = spline.velocity_sd[i - first];
    }
    square_sum += spline.noise * spline.noise * static_cast<double>(end - first);
    samples += static_cast<double>(end - first);
  }
  const auto [low, high] = finite_range(y);
  motion.is_known = samples > 0 && high - low >= 1e-5;
  motion.noise_m =
      std::max({std::sqrt(square_sum / std::max(samples, 1.0)), step / std::sqrt(12), 1e-7});

  motion.position_m = y;
  if (treated.has_faults) {
    Marks is_spoiled(n);
    for (std::size_t i = 0; i < n; ++i) {
      is_spoiled[i] = treated.is_spoiled(axis, i);
      if (!std::isfinite(treated.recording.position_m[axis][i])) motion.position_m[i] = kNone;
      if (is_spoiled[i]) motion.is_valid[i] = false;
    }
    const Marks is_near_fault = to_double(is_spoiled, 1);
    for (std::size_t i = 0; i < n; ++i) {
      motion.is_irregular[i] = motion.is_irregular[i] || is_near_fault[i];
    }
  }
  const double most = quantile(motion.position_m, 0.975) - quantile(motion.position_m, 0.025);
  motion.is_scored = motion.is_known && most >= 8 * motion.noise_m;
  return motion;
}

}  // namespace condyle::testing_support
