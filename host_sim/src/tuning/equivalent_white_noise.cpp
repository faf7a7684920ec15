// SPDX-License-Identifier: Apache-2.0
#include "tuning/equivalent_white_noise.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>

#include "condyle/estimator/motion/white_jerk.h"

namespace condyle::host {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr int kMostSteps = 200'000;

struct JerkStep {
  Matrix3d F, Q;  // Q of density 1
};

JerkStep jerk_step(double step_s) {
  const TransitionJacobian<double> J = white_jerk_jacobian(step_s);
  const SymmetricMatrix3<double> covariance = white_jerk_covariance(step_s);
  JerkStep step;
  step.F << 1, J.pv, J.px, 0, J.vv, J.vx, 0, 0, 1;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) step.Q(i, j) = covariance(std::min(i, j), std::max(i, j));
  }
  return step;
}

// The steady-state filter for white noise of variance 1 and jerk density `ratio`.
struct SettledFilter {
  Vector3d K;
  Matrix3d P;  // after the update
};

SettledFilter settle(const JerkStep& step, double ratio) {
  SettledFilter filter;
  filter.P = Matrix3d::Identity();
  filter.K.setZero();
  for (int i = 0; i < kMostSteps; ++i) {
    const Matrix3d predicted = step.F * filter.P * step.F.transpose() + ratio * step.Q;
    const Vector3d K = predicted.col(0) / (predicted(0, 0) + 1);
    const bool settled = (K - filter.K).norm() <= 1e-12 * K.norm();
    filter.K = K;
    filter.P = predicted - K * predicted.row(0);
    if (settled) break;
  }
  return filter;
}

// Steady-state covariance of the errors of `filter` if noise and motion are those of `model`.
Matrix3d error_covariance(const SettledFilter& filter, const JerkStep& step,
                          const NoiseModel& model, double step_s) {
  const double phi = std::exp(-step_s / model.correlation_time_s);
  const double noise_variance_m2 = model.position_sd_m * model.position_sd_m;
  const Matrix3d kept = Matrix3d::Identity() - filter.K * Vector3d::UnitX().transpose();
  Matrix4d A = Matrix4d::Zero();
  A.topLeftCorner<3, 3>() = kept * step.F;
  A.topRightCorner<3, 1>() = -phi * filter.K;
  A(3, 3) = phi;
  Matrix4d B = Matrix4d::Zero();
  B.topLeftCorner<3, 3>() = model.jerk_density_m2_s5 * kept * step.Q * kept.transpose();
  Eigen::Vector4d noise;
  noise << -filter.K, 1;
  B += (1 - phi * phi) * noise_variance_m2 * noise * noise.transpose();
  // Sum of A^k B A'^k, by doubling.
  Matrix4d sum = B;
  for (int i = 0; i < 60; ++i) {
    const Matrix4d more = A * sum * A.transpose();
    sum += more;
    if (more.norm() <= 1e-12 * sum.norm()) break;
    A = (A * A).eval();
  }
  return sum.topLeftCorner<3, 3>();
}

// Steady-state rms error of the velocity of the filter with the true `model`.
double best_velocity_error(const NoiseModel& model, double step_s) {
  NoiseFilter filter(model, {});
  filter.start(0);
  double velocity_variance = 0;
  for (int i = 0; i < kMostSteps; ++i) {
    filter.predict(step_s);
    (void)filter.update(0);
    const double before = velocity_variance;
    velocity_variance = filter.covariance()(1, 1);
    if (std::abs(velocity_variance - before) <= 1e-10 * velocity_variance) break;
  }
  return std::sqrt(velocity_variance);
}

}  // namespace

EquivalentWhiteNoise equivalent_white_noise(const NoiseModel& model, double step_s) {
  const JerkStep step = jerk_step(step_s);
  const double noise_variance_m2 = model.position_sd_m * model.position_sd_m;
  const double middle = std::log(model.jerk_density_m2_s5 / noise_variance_m2);
  const auto velocity_variance = [&](double log_ratio) {
    return error_covariance(settle(step, std::exp(log_ratio)), step, model, step_s)(1, 1);
  };
  constexpr int kBits = 20;
  const auto [log_ratio, variance] =
      boost::math::tools::brent_find_minima(velocity_variance, middle - 12, middle + 6, kBits);
  const double ratio = std::exp(log_ratio);
  const SettledFilter filter = settle(step, ratio);
  const Matrix3d error = error_covariance(filter, step, model, step_s);
  const double R = (error.diagonal().cwiseQuotient(filter.P.diagonal())).maxCoeff();
  EquivalentWhiteNoise stand_in;
  stand_in.white = {std::sqrt(R), ratio * R, 0};
  stand_in.velocity_error_m_s = std::sqrt(variance);
  stand_in.best_velocity_error_m_s = best_velocity_error(model, step_s);
  return stand_in;
}

}  // namespace condyle::host
