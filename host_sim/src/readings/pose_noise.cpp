// SPDX-License-Identifier: Apache-2.0
#include "readings/pose_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace condyle::host {
namespace {

constexpr double kBinomial12Over6 = 924;      // variance of a sixth difference of white noise
constexpr double kMedianOfSize = 0.67448975;  // of a standard normal number
constexpr double kLongestStep_s = 0.06;       // as long as the windows of LocalFit
constexpr std::size_t kMostDifferences = 200'000;

// Whether seven samples from `k` are evenly spaced.
bool is_even(const std::vector<double>& time_s, std::size_t k) {
  const double step_s = (time_s[k + 6] - time_s[k]) / 6;
  for (std::size_t i = 0; i < 6; ++i) {
    if (std::abs(time_s[k + i + 1] - time_s[k + i] - step_s) > 0.25 * step_s) return false;
  }
  return step_s < 0.1;
}

std::vector<Vector6> sixth_differences(const ReferredMotion& motion) {
  std::vector<Vector6> differences;
  const std::size_t count = motion.time_s.size();
  const std::size_t stride = 1 + count / kMostDifferences;
  for (std::size_t k = 0; k + 6 < count; k += stride) {
    if (!is_even(motion.time_s, k)) continue;
    const auto& m = motion.motion;
    differences.push_back(m[k] + m[k + 6] - 6 * (m[k + 1] + m[k + 5]) + 15 * (m[k + 2] + m[k + 4]) -
                          20 * m[k + 3]);
  }
  return differences;
}

double median_size(const std::vector<Vector6>& differences, int i) {
  std::vector<double> sizes;
  sizes.reserve(differences.size());
  for (const Vector6& difference : differences) sizes.push_back(std::abs(difference[i]));
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

// Ratio of the variance that second differences over `step` samples show to that over one, less
// what chance explains; of the component where it is largest.
double ratio_over(const ReferredMotion& motion, std::size_t begin, std::size_t end,
                  std::size_t step, const Matrix6& covariance) {
  double largest = 1;
  const double count = static_cast<double>(end - begin) - 2 * static_cast<double>(step);
  for (int i = 0; i < 6; ++i) {
    if (!(covariance(i, i) > 0)) continue;
    double sum = 0;
    for (std::size_t k = begin; k + 2 * step < end; ++k) {
      const double difference =
          motion.motion[k][i] - 2 * motion.motion[k + step][i] + motion.motion[k + 2 * step][i];
      sum += difference * difference;
    }
    const double ratio = sum / (6 * count) / covariance(i, i);
    // Neighbouring differences share samples: about half of them are independent.
    largest = std::max(largest, ratio / (1 + 3 * std::sqrt(4 / count)));
  }
  return largest;
}

}  // namespace

PoseNoise noise_of(const ReferredMotion& motion, std::size_t begin, std::size_t end) {
  PoseNoise noise;
  const std::vector<Vector6> differences = sixth_differences(motion);
  if (differences.size() < 7) return noise;
  Vector6 sd;
  for (int i = 0; i < 6; ++i) {
    sd[i] = median_size(differences, i) / kMedianOfSize / std::sqrt(kBinomial12Over6);
  }
  const double count = static_cast<double>(differences.size());
  for (int i = 0; i < 6; ++i) {
    noise.covariance(i, i) = sd[i] * sd[i];
    for (int j = 0; j < i; ++j) {
      double equal = 0;
      for (const Vector6& d : differences) {
        equal += d[i] * d[j] > 0 ? 1 : d[i] * d[j] < 0 ? -1 : 0;
      }
      const double correlation = std::sin(std::numbers::pi / 2 * equal / count);
      // Below what chance gives, no correlation.
      if (std::abs(equal) < 6 * std::sqrt(count)) continue;
      noise.covariance(i, j) = noise.covariance(j, i) = correlation * sd[i] * sd[j];
    }
  }
  const double step_s = (motion.time_s.back() - motion.time_s.front()) /
                        static_cast<double>(motion.time_s.size() - 1);
  const auto longest = static_cast<std::size_t>(std::max(2.0, kLongestStep_s / step_s));
  noise.is_checked_at_rest = end - begin >= 6 * longest;
  if (noise.is_checked_at_rest) {
    for (std::size_t step = 1; step <= longest; step *= 2) {
      noise.coloured =
          std::max(noise.coloured, ratio_over(motion, begin, end, step, noise.covariance));
    }
  }
  noise.covariance *= noise.coloured;
  // A root that changes little if the covariance does, so that readings do not depend on rounding.
  const Matrix6 raised =
      noise.covariance + Matrix6(noise.covariance.diagonal().asDiagonal()) * 1e-9;
  const Eigen::LLT<Matrix6> factor(raised);
  if (factor.info() == Eigen::Success) {
    noise.root = factor.matrixL();
  } else {
    noise.root = noise.covariance.diagonal().cwiseSqrt().asDiagonal();
    noise.covariance = noise.covariance.diagonal().asDiagonal();
  }
  return noise;
}

}  // namespace condyle::host
