// SPDX-License-Identifier: Apache-2.0
#include "readings/number_step.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace condyle::host {
namespace {

constexpr double kTolerance = 0.01;    // of a step
constexpr double kRounding_m = 1e-12;  // below which numbers are equal
constexpr std::size_t kFewest = 20;    // differences that show a step

}  // namespace

double step_of(const std::vector<double>& numbers) {
  std::vector<double> differences;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const double difference = std::abs(numbers[i] - numbers[i - 1]);
    if (difference > kRounding_m) differences.push_back(difference);
  }
  if (differences.size() < kFewest) return 0;
  const double step = *std::min_element(differences.begin(), differences.end());
  const bool is_step = std::all_of(differences.begin(), differences.end(), [step](double d) {
    return std::abs(d / step - std::round(d / step)) < kTolerance;
  });
  return is_step ? step : 0;
}

Matrix6 covariance_of_steps(const PoseTrack& track, std::size_t at) {
  Matrix6 steps = Matrix6::Zero();
  if (!(track.step_m > 0) || track.jaw.shape_m.cols() < 3) return steps;
  const PointColumns points_m = track.pose[at].linear() * track.jaw.shape_m;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < points_m.cols(); ++i) {
    const Eigen::Vector3d p = points_m.col(i);
    moments += p.squaredNorm() * Eigen::Matrix3d::Identity() - p * p.transpose();
  }
  steps.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / static_cast<double>(points_m.cols());
  steps.bottomRightCorner<3, 3>() = moments.inverse();
  return track.step_m * track.step_m / 12 * steps;
}

Matrix6 left_in_mean(const Matrix6& steps, const PoseNoise& noise) {
  if (steps.isZero(0)) return steps;
  const Vector6 ratios = noise.covariance.diagonal().cwiseQuotient(steps.diagonal());
  const double ratio = std::min(ratios.head<3>().mean(), ratios.tail<3>().mean());
  return std::exp(-std::numbers::pi * std::numbers::pi / 3 * std::max(ratio - 1, 0.0)) * steps;
}

}  // namespace condyle::host
