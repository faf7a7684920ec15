// SPDX-License-Identifier: Apache-2.0
#include "readings/slope_noise.h"

#include <algorithm>
#include <cmath>

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr double kLongestShared = 4;   // lag over tau; beyond it nothing is shared
constexpr double kLongestOfHum_s = 1;  // beyond any two samples of a slope

}  // namespace

Vector3d Slope::of(const Places& places) const {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * places[first + i];
  return sum;
}

double Slope::gain() const {
  double sum = 0;
  for (const double weight : weights) sum += weight * weight;
  return sum;
}

Slope Slope::mixed(double a, const Slope& other, double b) const {
  Slope sum;
  sum.first = std::min(first, other.first);
  sum.weights.resize(
      std::max(first + weights.size(), other.first + other.weights.size()) - sum.first, 0.0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum.weights[first - sum.first + i] += a * weights[i];
  }
  for (std::size_t i = 0; i < other.weights.size(); ++i) {
    sum.weights[other.first - sum.first + i] += b * other.weights[i];
  }
  return sum;
}

double NoiseAlong::variance_of(const Slope& slope) const {
  double sum = white * slope.gain();
  const std::vector<double>& weights = slope.weights;
  for (std::size_t i = 0; i < weights.size() && !shared.empty(); ++i) {
    double others = 0.5 * weights[i] * shared[0];
    for (std::size_t lag = 1; lag <= i && lag < shared.size(); ++lag) {
      others += weights[i - lag] * shared[lag];
    }
    sum += 2 * weights[i] * others;
  }
  return std::max(sum, 0.0);
}

NoiseAlong along(const Vector3d& direction, const PointNoise& noise,
                 const std::vector<SharedNoise>& shared, double step_s) {
  NoiseAlong result;
  result.white = direction.dot(noise.white * direction);
  for (std::size_t j = 0; j < noise.shared.size(); ++j) {
    const double variance = direction.dot(noise.shared[j] * direction);
    const SharedNoise& part = shared[j];
    const double longest_s = part.frequency_Hz > 0
                                 ? std::min(kLongestShared * part.tau_s, kLongestOfHum_s)
                                 : kLongestShared * part.tau_s;
    const auto lags = static_cast<std::size_t>(longest_s / step_s) + 1;
    if (result.shared.size() < lags) result.shared.resize(lags, 0.0);
    for (std::size_t lag = 0; lag < lags; ++lag) {
      result.shared[lag] += variance * part.correlation(static_cast<double>(lag) * step_s);
    }
  }
  return result;
}

NoiseAlong across(const Vector3d& direction, const PointNoise& noise,
                  const std::vector<SharedNoise>& shared, double step_s) {
  NoiseAlong result, here = along(direction, noise, shared, step_s);
  for (int i = 0; i < 3; ++i) {
    const NoiseAlong axis = along(Vector3d::Unit(i), noise, shared, step_s);
    result.white += axis.white;
    result.shared.resize(axis.shared.size(), 0.0);
    for (std::size_t lag = 0; lag < axis.shared.size(); ++lag) {
      result.shared[lag] += axis.shared[lag];
    }
  }
  result.white -= here.white;
  for (std::size_t lag = 0; lag < here.shared.size(); ++lag) {
    result.shared[lag] -= here.shared[lag];
  }
  return result;
}

}  // namespace condyle::host
