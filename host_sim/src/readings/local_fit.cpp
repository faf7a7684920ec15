// SPDX-License-Identifier: Apache-2.0
#include "readings/local_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace condyle::host {
namespace {

// First and end of the samples that the fit at `k` uses.
std::pair<std::size_t, std::size_t> window_at(const std::vector<double>& time_s, std::size_t k,
                                              double half_width_s) {
  std::size_t first = k, end = k + 1;
  const auto grow = [&](double width_s) {
    while (first > 0 && time_s[k] - time_s[first - 1] <= width_s + 1e-9) --first;
    while (end < time_s.size() && time_s[end] - time_s[k] <= width_s + 1e-9) ++end;
  };
  grow(half_width_s);
  while (end - first < kLeastFitSamples) {
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

LocalFit::LocalFit(const std::vector<double>& time_s, std::size_t begin, std::size_t end,
                   double half_width_s) {
  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  first_used_ = begin;
  end_used_ = end;
  for (std::size_t k = begin; k < end; ++k) {
    ranges.push_back(window_at(time_s, k, half_width_s));
    first_used_ = std::min(first_used_, ranges.back().first);
    end_used_ = std::max(end_used_, ranges.back().second);
  }
  for (std::size_t k = begin; k < end; ++k) {
    const auto [first, last] = ranges[k - begin];
    const std::size_t count = last - first;
    Window window{first - first_used_, {}, {}};
    // At a border, where all samples lie on one side, a quadratic: a cubic would follow the noise.
    const bool is_border = first == k || last == k + 1;
    const int terms = count >= kLeastFitSamples ? (is_border ? 3 : 4) : count >= 2 ? 2 : 1;
    Eigen::Matrix4d normal = Eigen::Matrix4d::Identity();
    normal.topLeftCorner(terms, terms).setZero();
    const auto powers = [&](std::size_t i) {
      const double x = (time_s[i] - time_s[k]) / kFitHalfWidth_s;
      Eigen::Vector4d row(1, x, x * x, x * x * x);
      row.tail(4 - terms).setZero();
      return row;
    };
    for (std::size_t i = first; i < last; ++i) normal += powers(i) * powers(i).transpose();
    const Eigen::Matrix4d inverse = normal.inverse();
    for (std::size_t i = first; i < last; ++i) {
      const Eigen::Vector4d weights = inverse * powers(i);
      window.value_weights.push_back(weights[0]);
      window.slope_weights.push_back(weights[1] / kFitHalfWidth_s);
    }
    windows_.push_back(std::move(window));
  }
}

void LocalFit::apply(const std::vector<Vector6>& samples, std::vector<Vector6>& values,
                     std::vector<Vector6>& slopes) const {
  values.resize(windows_.size());
  slopes.resize(windows_.size());
  for (std::size_t k = 0; k < windows_.size(); ++k) {
    const Window& window = windows_[k];
    Vector6 value = Vector6::Zero(), slope = Vector6::Zero();
    for (std::size_t i = 0; i < window.value_weights.size(); ++i) {
      const Vector6& sample = samples[window.first + i];
      value += window.value_weights[i] * sample;
      slope += window.slope_weights[i] * sample;
    }
    values[k] = value;
    slopes[k] = slope;
  }
}

std::vector<double> LocalFit::gains() const {
  std::vector<double> gains;
  for (const Window& window : windows_) {
    double sum = 0;
    for (const double weight : window.value_weights) sum += weight * weight;
    gains.push_back(sum);
  }
  return gains;
}

}  // namespace condyle::host
