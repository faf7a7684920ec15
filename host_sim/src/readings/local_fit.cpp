// SPDX-License-Identifier: Apache-2.0
#include "readings/local_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "readings/polynomial_fit.h"

namespace condyle::host {
namespace {

using Pair = double __attribute__((vector_size(16)));

// First and end of the samples that the fit at `k` uses.
std::pair<std::size_t, std::size_t> window_at(const std::vector<double>& time_s, std::size_t k,
                                              double half_width_s, std::size_t least_samples) {
  std::size_t first = k, end = k + 1;
  const auto grow = [&](double width_s) {
    while (first > 0 && time_s[k] - time_s[first - 1] <= width_s + 1e-9) --first;
    while (end < time_s.size() && time_s[end] - time_s[k] <= width_s + 1e-9) ++end;
  };
  grow(half_width_s);
  while (end - first < least_samples) {
    const bool has_before = first > 0, has_after = end < time_s.size();
    if (!has_before && !has_after) break;
    const double before_s = has_before ? time_s[k] - time_s[first - 1] : 1e300;
    const double after_s = has_after ? time_s[end] - time_s[k] : 1e300;
    if (std::min(before_s, after_s) > std::max(kWidestFit_s, half_width_s)) break;
    if (before_s <= after_s) {
      --first;
    } else {
      ++end;
    }
  }
  return {first, end};
}

}  // namespace

double slope_gain(double rate_Hz) {
  const auto half = static_cast<std::size_t>(kFitHalfWidth_s * rate_Hz + 1e-9);
  const std::size_t reach = std::max(half, kLeastFitSamples / 2);
  // Of the samples i / rate, the slope of a cubic: sums of their even powers.
  double s2 = 0, s4 = 0, s6 = 0;
  for (std::size_t i = 1; i <= reach; ++i) {
    const double square = static_cast<double>(i * i);
    s2 += 2 * square;
    s4 += 2 * square * square;
    s6 += 2 * square * square * square;
  }
  return rate_Hz * std::sqrt(s6 / (s2 * s6 - s4 * s4));
}

SampleRun samples_of_fit(const std::vector<double>& time_s, std::size_t begin, std::size_t end,
                         double half_width_s) {
  SampleRun used{begin, end};
  for (std::size_t k = begin; k < end; ++k) {
    const auto [first, last] = window_at(time_s, k, half_width_s, kLeastFitSamples);
    used = {std::min(used.begin, first), std::max(used.end, last)};
  }
  return used;
}

LocalFit::LocalFit(const std::vector<double>& time_s, std::size_t begin, std::size_t end,
                   double half_width_s, std::size_t least_samples)
    : begin_(begin), end_(end), used_{begin, end} {
  windows_.reserve(end - begin);
  std::size_t count = 0;
  for (std::size_t k = begin; k < end; ++k) {
    const auto [first, last] = window_at(time_s, k, half_width_s, least_samples);
    windows_.push_back({first, last - first, count});
    count += last - first;
    used_ = {std::min(used_.begin, first), std::max(used_.end, last)};
  }
  weights_.resize(count);
  std::vector<double> places;
  for (std::size_t k = begin; k < end; ++k) {
    const Window& window = windows_[k - begin];
    // At a border, where all samples lie on one side, a quadratic: a cubic would follow the noise.
    const bool is_border = window.first == k || window.first + window.count == k + 1;
    const int terms = window.count >= least_samples ? (is_border ? 3 : 4)
                      : window.count >= 2           ? 2
                                                    : 1;
    places.resize(window.count);
    for (std::size_t i = 0; i < window.count; ++i) {
      places[i] = (time_s[window.first + i] - time_s[k]) / kFitHalfWidth_s;
    }
    PowerSums powers;
    for (const double place : places) powers.add(place);
    const auto [of_value, of_slope] = powers.rows(terms);
    for (std::size_t i = 0; i < window.count; ++i) {
      const double x = places[i];
      const auto weight = [x](const Eigen::RowVector4d& row) {
        return row[0] + x * (row[1] + x * (row[2] + x * row[3]));
      };
      weights_[window.weights + i] = {weight(of_value), weight(of_slope) / kFitHalfWidth_s};
    }
  }
}

void LocalFit::apply(const std::vector<Vector6>& samples, std::size_t first_sample,
                     std::size_t begin, std::size_t end, std::vector<Vector6>& values,
                     std::vector<Vector6>& slopes) const {
  values.resize(end - begin);
  slopes.resize(end - begin);
  for (std::size_t k = begin; k < end; ++k) {
    const Window& window = windows_[k - begin_];
    const Weights* const weights = &weights_[window.weights];
    const Vector6* const used = &samples[window.first - first_sample];
    // Sums in registers.
    std::array<Pair, 3> value{}, slope{};
    for (std::size_t i = 0; i < window.count; ++i) {
      const double* const sample = used[i].data();
      const double of_value = weights[i].value, of_slope = weights[i].slope;
#pragma GCC unroll 3
      for (std::size_t j = 0; j < 3; ++j) {
        Pair pair;
        std::memcpy(&pair, sample + 2 * j, sizeof pair);
        value[j] += of_value * pair;
        slope[j] += of_slope * pair;
      }
    }
    std::memcpy(values[k - begin].data(), value.data(), sizeof value);
    std::memcpy(slopes[k - begin].data(), slope.data(), sizeof slope);
  }
}

std::vector<double> LocalFit::gains() const {
  std::vector<double> gains;
  gains.reserve(windows_.size());
  for (const Window& window : windows_) {
    double sum = 0;
    for (std::size_t i = 0; i < window.count; ++i) {
      const double weight = weights_[window.weights + i].value;
      sum += weight * weight;
    }
    gains.push_back(sum);
  }
  return gains;
}

std::vector<Vector6> slopes_of(const std::vector<double>& time_s,
                               const std::vector<Vector6>& values) {
  const std::size_t count = values.size(), points = std::min<std::size_t>(5, count);
  std::vector<Vector6> slopes(count, Vector6::Zero());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first =
        std::clamp<std::size_t>(k, points / 2, count - points + points / 2) - points / 2;
    for (std::size_t j = first; j < first + points; ++j) {
      // Derivative at k of the polynomial that is 1 at j and 0 at the others.
      double weight = 0;
      if (j == k) {
        for (std::size_t m = first; m < first + points; ++m) {
          if (m != k) weight += 1 / (time_s[k] - time_s[m]);
        }
      } else {
        weight = 1 / (time_s[j] - time_s[k]);
        for (std::size_t m = first; m < first + points; ++m) {
          if (m != j && m != k) weight *= (time_s[k] - time_s[m]) / (time_s[j] - time_s[m]);
        }
      }
      slopes[k] += weight * values[j];
    }
  }
  return slopes;
}

}  // namespace condyle::host
