// SPDX-License-Identifier: Apache-2.0
#include "real_motion/smoothing_spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace condyle::testing_support {
namespace {

using Values = std::vector<double>;
using std::numbers::pi;

double square(double value) {
  return value * value;
}

// What a second-order difference of frequency `w` (radians a sample) is worth in the penalty.
double stiffness(double w) {
  return std::pow(2 - 2 * std::cos(w), 3);
}

struct LowPass {
  std::array<double, 3> b, a;
};

LowPass butterworth_coefficients(double cutoff) {
  const double k = std::tan(pi * cutoff), norm = 1 + std::numbers::sqrt2 * k + k * k;
  const double b = k * k / norm;
  return {{b, 2 * b, b}, {1, 2 * (k * k - 1) / norm, (1 - std::numbers::sqrt2 * k + k * k) / norm}};
}

// One way, from the steady state that belongs to the first value.
Values run(const LowPass& filter, Values x) {
  const auto& [b, a] = filter;
  double later = (b[2] - a[2]) * x[0], next = (b[1] - a[1]) * x[0] + later;
  for (double& value : x) {
    const double in = value;
    value = b[0] * in + next;
    next = b[1] * in - a[1] * value + later;
    later = b[2] * in - a[2] * value;
  }
  return x;
}

}  // namespace

// (1 + lambda D'D) x = y, D the third differences, by Cholesky's method.
Values smooth(const Values& y, double lambda) {
  constexpr std::array<double, 4> kDifference = {-1, 3, -3, 1};
  const std::size_t n = y.size();
  std::vector<std::array<double, 4>> L(n, {1, 0, 0, 0});  // row i: (i, i), (i, i - 1), ...
  for (std::size_t i = 0; i + 3 < n; ++i) {
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        L[i + a][a - b] += lambda * kDifference[a] * kDifference[b];
      }
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

// Coefficients c of B-splines on even knots, two beyond each end. Through a sample:
// x[i] = (c[i - 2] + 26 c[i - 1] + 66 c[i] + 26 c[i + 1] + c[i + 2]) / 120. A sixth difference of c
// that is zero keeps the fifth derivative continuous at its middle.
Values spline_derivative(const Values& x, double T) {
  constexpr std::size_t kReach = 6;  // of a row to both sides of its diagonal
  constexpr std::array<double, 7> kSmoothKnot = {1, -6, 15, -20, 15, -6, 1};
  constexpr std::array<double, 5> kThroughSample = {1, 26, 66, 26, 1};
  const std::size_t n = x.size(), unknowns = n + 4;
  std::vector<std::array<double, 2 * kReach + 1>> rows(unknowns, {0});
  Values c(unknowns, 0);
  const auto set = [&](std::size_t row, std::size_t first, const auto& entries) {
    for (std::size_t k = 0; k < entries.size(); ++k)
      rows[row][first + k + kReach - row] = entries[k];
  };
  set(0, 0, kSmoothKnot);
  set(1, 1, kSmoothKnot);
  for (std::size_t i = 0; i < n; ++i) {
    set(i + 2, i, kThroughSample);
    c[i + 2] = 120 * x[i];
  }
  set(n + 2, n - 4, kSmoothKnot);
  set(n + 3, n - 3, kSmoothKnot);
  for (std::size_t i = 0; i < unknowns; ++i) {
    const std::size_t end = std::min(i + kReach + 1, unknowns);
    for (std::size_t below = i + 1; below < end; ++below) {
      const double factor = rows[below][i + kReach - below] / rows[i][kReach];
      if (factor == 0) continue;
      for (std::size_t k = i; k < end; ++k) {
        rows[below][k + kReach - below] -= factor * rows[i][k + kReach - i];
      }
      c[below] -= factor * c[i];
    }
  }
  for (std::size_t i = unknowns; i-- > 0;) {
    for (std::size_t k = i + 1; k < std::min(i + kReach + 1, unknowns); ++k) {
      c[i] -= rows[i][k + kReach - i] * c[k];
    }
    c[i] /= rows[i][kReach];
  }
  Values derivative(n);
  for (std::size_t i = 0; i < n; ++i) {
    derivative[i] = (c[i + 4] - c[i] + 10 * (c[i + 3] - c[i + 1])) / (24 * T);
  }
  return derivative;
}

Values butterworth(const Values& x, double cutoff) {
  constexpr std::size_t kPad = 9;
  const std::size_t n = x.size();
  Values padded;
  for (std::size_t k = kPad; k > 0; --k) padded.push_back(2 * x.front() - x[k]);
  padded.insert(padded.end(), x.begin(), x.end());
  for (std::size_t k = 1; k <= kPad; ++k) padded.push_back(2 * x.back() - x[n - 1 - k]);
  const LowPass filter = butterworth_coefficients(cutoff);
  for (int way = 0; way < 2; ++way) {
    padded = run(filter, padded);
    std::reverse(padded.begin(), padded.end());
  }
  return {padded.begin() + kPad, padded.end() - kPad};
}

SplineVelocity fit_smoothing_spline(const Values& y, double T) {
  const std::size_t n = y.size();
  const auto count = static_cast<double>(n);
  Values stiff(n);
  for (std::size_t i = 0; i < n; ++i) stiff[i] = stiffness(pi * static_cast<double>(i) / count);
  const auto cutoff_Hz = [T](double lambda) {
    return std::acos(std::max(-1.0, 1 - 0.5 * std::min(4.0, std::cbrt(1 / lambda)))) / (2 * pi * T);
  };
  struct Fit {
    double lambda, freedom, residual;  // residual: sum of squares
    Values x;
  };
  const auto fit = [&](double lambda) {
    Fit one{lambda, 0, 0, smooth(y, lambda)};
    for (std::size_t i = 0; i < n; ++i) {
      one.freedom += 1 - 1 / (1 + lambda * stiff[i]);
      one.residual += square(y[i] - one.x[i]);
    }
    return one;
  };
  Fit best = fit(1e-2);
  double best_score = HUGE_VAL;
  for (double exponent = -3; exponent < 13.1; exponent += 0.5) {
    const double lambda = std::pow(10, exponent);
    if (cutoff_Hz(lambda) < 1) break;
    Fit one = fit(lambda);
    const double score = one.residual / square(one.freedom);
    if (one.freedom < 0.02 * count || score >= best_score) continue;
    best_score = score;
    best = std::move(one);
  }
  const double variance = best.residual / std::max(best.freedom, 1.0);
  SplineVelocity result{std::sqrt(variance), spline_derivative(best.x, T), {}};
  double gain = 0;
  constexpr int kFrequencies = 513;
  for (int k = 0; k < kFrequencies; ++k) {
    const double w = pi * k / (kFrequencies - 1);
    gain += square(w / (1 + best.lambda * stiffness(w))) / kFrequencies;
  }
  const double cut_Hz = std::min(
      std::max(0.9 * (best_score < HUGE_VAL ? cutoff_Hz(best.lambda) : 0.5 / T), 2.0), 0.45 / T);
  Values bias(n, 0);
  for (const Values& other :
       {smooth(y, best.lambda / 8), smooth(y, best.lambda * 8), butterworth(y, cut_Hz * T)}) {
    const Values velocity = spline_derivative(other, T);
    for (std::size_t i = 0; i < n; ++i) bias[i] += 0.25 * square(velocity[i] - result.velocity[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    double mean = 0;
    for (std::size_t j = i < 4 ? 0 : i - 4; j < std::min(i + 5, n); ++j) mean += bias[j] / 9;
    result.velocity_sd.push_back(std::sqrt(variance * gain / square(T) + mean));
  }
  return result;
}

}  // namespace condyle::testing_support
