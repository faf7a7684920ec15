// SPDX-License-Identifier: Apache-2.0
#include "readings/abrupt_parts.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace condyle::host {
namespace {

// Exceeded by chi-square of six degrees of freedom with a probability of 1e-8.
constexpr double kBeyondNoise = 48;
// Keeps the covariance invertible if a recording has no noise (m^2, rad^2).
constexpr double kLeastVariance = 1e-20;
constexpr double kRounding_s = 1e-9;

}  // namespace

void AbruptParts::add_noise(const std::vector<Vector6>& narrow, const std::vector<Vector6>& wide) {
  for (std::size_t k = 0; k < wide.size(); ++k) {
    const Vector6 difference = narrow[k] - wide[k];
    sum_ += difference * difference.transpose();
  }
  count_ += static_cast<double>(wide.size());
}

std::vector<bool> AbruptParts::of(const SmoothMotion& narrow, const SmoothMotion& wide) const {
  if (count_ == 0 || wide.time_s.empty()) return {};
  const auto& time_s = wide.time_s;
  const Eigen::LLT<Matrix6> covariance(sum_ / count_ + kLeastVariance * Matrix6::Identity());
  // At low rates the usual window is longer.
  const double step_s = (time_s.back() - time_s.front()) /
                        static_cast<double>(std::max<std::size_t>(time_s.size(), 2) - 1);
  const double reach_s =
      std::max(kFitHalfWidth_s, static_cast<double>(kLeastFitSamples / 2) * step_s) + kRounding_s;
  std::vector<bool> is_abrupt;
  std::size_t end = 0;  // all before it are decided
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    const Vector6 difference = narrow.value[k] - wide.value[k];
    if (!(covariance.matrixL().solve(difference).squaredNorm() > kBeyondNoise)) continue;
    is_abrupt.resize(time_s.size(), false);
    std::size_t first = k;
    while (first > end && time_s[k] - time_s[first - 1] <= reach_s) --first;
    for (end = std::max(end, first);
         end < time_s.size() && (end <= k || time_s[end] - time_s[k] <= reach_s); ++end) {
      is_abrupt[end] = true;
    }
  }
  return is_abrupt;
}

SmoothMotion narrowed_where(const std::vector<bool>& is_narrow, const SmoothMotion& narrow,
                            SmoothMotion wide) {
  for (std::size_t k = 0; k < is_narrow.size(); ++k) {
    if (!is_narrow[k]) continue;
    wide.value[k] = narrow.value[k];
    wide.slope[k] = narrow.slope[k];
  }
  return wide;
}

}  // namespace condyle::host
