// SPDX-License-Identifier: Apache-2.0
#include "readings/calm_window.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "readings/local_fit.h"

namespace condyle::host {
namespace {

constexpr double kSlack = 1.5, kTimesSd = 6, kWindow_s = 0.1;
// Rounding of a sample (m, rad): a recording without noise follows no polynomial exactly.
constexpr double kRounding_m = 1e-6, kRounding_rad = 1e-5;

bool contradicts(const ReferredMotion& motion, std::size_t begin, std::size_t end,
                 const PoseNoise& noise, double half_s) {
  const LocalFit fit(motion.time_s, begin, end, half_s);
  std::vector<Vector6> smooth, slopes;
  fit.apply(motion.motion, 0, smooth, slopes);
  const std::vector<double> gains = fit.gains();
  Matrix6 covariance = noise.covariance;
  covariance.diagonal().head<3>().array() += kRounding_m * kRounding_m;
  covariance.diagonal().tail<3>().array() += kRounding_rad * kRounding_rad;
  const Matrix6 information = covariance.inverse();
  double longest_s = 0;  // that neighbours share noise
  for (const SharedNoise& part : noise.shared) longest_s = std::max(longest_s, part.tau_s);
  // Running mean of q from sample `oldest` on.
  std::vector<double> qs;
  double sum = 0;
  std::size_t oldest = begin;
  for (std::size_t k = begin; k < end; ++k) {
    const Vector6 d = motion.motion[k] - smooth[k - begin];
    const Vector6 weighted = information * d;
    double square = d.dot(weighted);
    if (noise.stamp_sd_s > 0) {
      // C + tau^2 v v' (Sherman, Morrison).
      const Vector6 step = noise.stamp_sd_s * slopes[k - begin];
      const double along = step.dot(weighted);
      square -= along * along / (1 + step.dot(information * step));
    }
    qs.push_back(square / 6 / std::max(1 - gains[k - begin], 0.1));
    sum += qs.back();
    const double span_s = motion.time_s[k] - motion.time_s[oldest];
    while (motion.time_s[k] - motion.time_s[oldest] > kWindow_s && k - oldest >= kLeastFitSamples) {
      sum -= qs[oldest++ - begin];
    }
    const auto count = static_cast<double>(k - oldest + 1);
    if (count < static_cast<double>(kLeastFitSamples)) continue;
    const double alone = longest_s > 0 ? std::clamp(span_s / (2 * longest_s), 1.0, count) : count;
    if (sum / count > kSlack + kTimesSd * std::sqrt(2 / (6 * alone))) return true;
  }
  return false;
}

}  // namespace

double calm_half_width_s(const ReferredMotion& motion, std::size_t begin, std::size_t end,
                         const PoseNoise& noise, double widest_s, double least_s) {
  double half_s = widest_s;
  while (half_s > least_s && contradicts(motion, begin, end, noise, half_s)) {
    half_s /= std::numbers::sqrt2;
  }
  return std::max(half_s, std::min(least_s, widest_s));
}

}  // namespace condyle::host
