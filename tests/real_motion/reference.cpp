// SPDX-License-Identifier: Apache-2.0
#include "real_motion/reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace condyle::testing_support {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kShortest = 30, kEnd = 4;
using Values = std::vector<double>;

double quantile(Values values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// The step of a recorded grid; 0 where there is none.
double recorded_step(const Values& y) {
  std::set<double> levels;
  for (const double value : y) {
    if (std::isfinite(value)) levels.insert(value);
  }
  Values gaps;
  for (auto level = levels.begin(); levels.size() > 3 && std::next(level) != levels.end();
       ++level) {
    if (*std::next(level) - *level > 1e-12) gaps.push_back(*std::next(level) - *level);
  }
  const double step = quantile(gaps, 0.05);
  if (!(step > 2e-7)) return 0;
  const auto fit = std::count_if(gaps.begin(), gaps.end(), [step](double gap) {
    return std::abs(gap / step - std::round(gap / step)) < 0.05;
  });
  return static_cast<double>(fit) > 0.95 * static_cast<double>(gaps.size()) ? step : 0;
}

// Smooths `y`: (1 + lambda D'D) x = y, D the third differences; Cholesky of a band of four.
Values smoothed(const Values& y, double lambda) {
  constexpr std::array<double, 4> kDifference = {-1, 3, -3, 1};
  const std::size_t n = y.size();
  std::vector<std::array<double, 4>> L(n);  // row i: entries (i, i), (i, i - 1), ...
  for (auto& row : L) row = {1, 0, 0, 0};
  for (std::size_t i = 0; i + 3 < n; ++i) {
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b <= a; ++b)
        L[i + a][a - b] += lambda * kDifference[a] * kDifference[b];
    }
  }
  Values x = y;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = std::min<std::size_t>(i, 3) + 1; k-- > 0;) {
      double sum = L[i][k];
      for (std::size_t m = k + 1; m < 4 && m <= i; ++m) sum -= L[i][m] * L[i - k][m - k];
      L[i][k] = k == 0 ? std::sqrt(sum) : sum / L[i - k][0];
    }
    for (std::size_t k = 1; k < 4 && k <= i; ++k) x[i] -= L[i][k] * x[i - k];
    x[i] /= L[i][0];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = 1; k < 4 && i + k < n; ++k) x[i] -= L[i + k][k] * x[i + k];
    x[i] /= L[i][0];
  }
  return x;
}

// Derivative of evenly sampled values, sixth order; NaN at the ends.
Values derivative(const Values& x, double T) {
  Values v(x.size(), kNone);
  for (std::size_t i = 3; i + 3 < x.size(); ++i) {
    v[i] =
        (45 * (x[i + 1] - x[i - 1]) - 9 * (x[i + 2] - x[i - 2]) + x[i + 3] - x[i - 3]) / (60 * T);
  }
  return v;
}

struct Spline {
  double noise = 0;
  Values velocity, velocity_sd;
};

Spline fit_spline(const Values& y, double T) {
  const std::size_t n = y.size();
  const auto count = static_cast<double>(n);
  double best_score = HUGE_VAL, best_lambda = 1, square = 0;
  const auto stiffness = [](double w) { return std::pow(2 - 2 * std::cos(w), 3); };
  for (double exponent = -3; exponent <= 13; exponent += 0.5) {
    const double lambda = std::pow(10, exponent);
    double trace = 0, residual = 0;
    for (std::size_t i = 0; i < n; ++i) {
      trace += 1 / (1 + lambda * stiffness(std::numbers::pi * static_cast<double>(i) / count));
    }
    if (count - trace < 0.02 * count) continue;
    const Values x = smoothed(y, lambda);
    for (std::size_t i = 0; i < n; ++i) residual += (y[i] - x[i]) * (y[i] - x[i]);
    const double score = residual / ((count - trace) * (count - trace));
    if (score >= best_score) continue;
    best_score = score;
    best_lambda = lambda;
    square = residual / (count - trace);
  }
  Spline spline;
  spline.noise = std::sqrt(square);
  spline.velocity = derivative(smoothed(y, best_lambda), T);
  const Values rougher = derivative(smoothed(y, best_lambda / 8), T);
  const Values stiffer = derivative(smoothed(y, best_lambda * 8), T);
  double gain = 0;
  constexpr int kFrequencies = 256;
  for (int k = 0; k < kFrequencies; ++k) {
    const double w = std::numbers::pi * (k + 0.5) / kFrequencies;
    gain += std::pow(w / (1 + best_lambda * stiffness(w)), 2) / kFrequencies;
  }
  const double formal = square * gain / (T * T);
  for (std::size_t i = 0; i < n; ++i) {
    double bias = 0, terms = 0;
    for (std::size_t j = i < 4 ? 0 : i - 4; j < std::min(i + 5, n); ++j) {
      if (!std::isfinite(spline.velocity[j])) continue;
      bias += 0.25 * (std::pow(rougher[j] - spline.velocity[j], 2) +
                      std::pow(stiffer[j] - spline.velocity[j], 2));
      ++terms;
    }
    spline.velocity_sd.push_back(std::sqrt(formal + bias / std::max(terms, 1.0)));
  }
  return spline;
}

// True within `reach` samples of a marked one.
std::vector<bool> near(const std::vector<bool>& marked, std::size_t reach) {
  std::vector<bool> result(marked.size(), false);
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (!marked[i]) continue;
    for (std::size_t j = i < reach ? 0 : i - reach; j < std::min(i + reach + 1, marked.size());
         ++j) {
      result[j] = true;
    }
  }
  return result;
}

struct Regularity {
  std::vector<bool> is_irregular, is_smooth;  // |e| > 8 s; |e| <= 4 s
};

Regularity judge(const Values& y, double step) {
  const std::size_t n = y.size();
  Values e(n, kNone), all;
  for (std::size_t i = 2; i + 2 < n; ++i) {
    e[i] = std::abs(y[i] - (4 * (y[i - 1] + y[i + 1]) - y[i - 2] - y[i + 2]) / 6);
    if (e[i] > 0) all.push_back(e[i]);
  }
  const double floor = std::max({0.25 * 1.4826 * quantile(all, 0.5), 0.6 * step, 1e-7});
  Regularity result{std::vector<bool>(n, false), std::vector<bool>(n, false)};
  for (std::size_t i = 2; i + 2 < n; ++i) {
    Values around;
    for (std::size_t j = i < 25 ? 0 : i - 25; j < std::min(i + 26, n); ++j) {
      if (std::isfinite(e[j])) around.push_back(e[j]);
    }
    const double s = around.size() < 10 ? floor : std::max(1.4826 * quantile(around, 0.5), floor);
    result.is_irregular[i] = e[i] > 8 * s;
    result.is_smooth[i] = e[i] <= 4 * s;
  }
  return result;
}

}  // namespace

ReferenceMotion reference_motion(const RealRecording& recording, std::size_t axis) {
  const Values& y = recording.position_m[axis];
  const std::size_t n = y.size();
  const double T = recording.step_s(), step = recorded_step(y);
  ReferenceMotion motion;
  motion.is_irregular.assign(n, false);
  for (const Values& other : recording.position_m) {
    const auto judged = judge(other, recorded_step(other));
    for (std::size_t i = 0; i < n; ++i) {
      motion.is_irregular[i] = motion.is_irregular[i] || judged.is_irregular[i];
    }
  }
  const auto is_near = near(motion.is_irregular, 2);
  const auto own = judge(y, step);
  for (std::size_t i = 0; i < n; ++i) {
    motion.is_valid.push_back(recording.is_measured(i) && !is_near[i] && own.is_smooth[i]);
  }
  motion.velocity_m_s.assign(n, kNone);
  motion.velocity_sd_m_s.assign(n, kNone);
  const auto is_usable = [&](std::size_t i) { return recording.is_measured(i) && !is_near[i]; };
  double square_sum = 0, samples = 0;
  for (std::size_t first = 0; first < n;) {
    std::size_t end = first;
    while (end < n && is_usable(end) &&
           (end == first || recording.time_s[end] - recording.time_s[end - 1] < 1.5 * T)) {
      ++end;
    }
    if (end - first >= kShortest) {
      const Spline spline = fit_spline(Values(y.begin() + static_cast<std::ptrdiff_t>(first),
                                              y.begin() + static_cast<std::ptrdiff_t>(end)),
                                       T);
      for (std::size_t i = first + kEnd; i + kEnd < end; ++i) {
        motion.velocity_m_s[i] = spline.velocity[i - first];
        motion.velocity_sd_m_s[i] = spline.velocity_sd[i - first];
      }
      square_sum += spline.noise * spline.noise * static_cast<double>(end - first);
      samples += static_cast<double>(end - first);
    }
    first = std::max(end, first + 1);
  }
  Values measured;
  std::copy_if(y.begin(), y.end(), std::back_inserter(measured),
               [](double value) { return std::isfinite(value); });
  const double range = quantile(measured, 0.975) - quantile(measured, 0.025);
  motion.noise_m =
      std::max({std::sqrt(square_sum / std::max(samples, 1.0)), step / std::sqrt(12), 1e-7});
  motion.is_scored = samples > 0 && range > std::max(8 * motion.noise_m, 1e-5);
  return motion;
}

}  // namespace condyle::testing_support
