// SPDX-License-Identifier: Apache-2.0
#include "tuning/innovation_likelihood.h"

#include "condyle/estimator/motion/white_jerk.h"

namespace condyle::host {
namespace {

constexpr int kNoise = 3;  // index of n

double squared(double value) {
  return value * value;
}

}  // namespace

void NoiseFilter::start(double z_m) {
  const double R = squared(model_.position_sd_m);
  x_ = {z_m, 0, 0, 0};
  P_.setZero();
  P_.diagonal() << R, squared(prior_.velocity_sd_m_s), squared(prior_.acceleration_sd_m_s2), R;
  P_(kPosition, kNoise) = P_(kNoise, kPosition) = -R;  // p = z - n
}

void NoiseFilter::predict(double step_s) {
  const double tau_s = model_.correlation_time_s;
  const double phi = tau_s > 0 ? std::exp(-step_s / tau_s) : 0;
  const TransitionJacobian<double> step = white_jerk_jacobian(step_s);
  Eigen::Matrix4d F = Eigen::Matrix4d::Zero();
  F << 1, step.pv, step.px, 0,  //
      0, step.vv, step.vx, 0,   //
      0, 0, 1, 0,               //
      0, 0, 0, phi;
  const SymmetricMatrix3<double> Q = white_jerk_covariance(step_s);
  x_ = F * x_;
  P_ = F * P_ * F.transpose();
  for (int i = 0; i < kNoise; ++i) {
    for (int j = 0; j < kNoise; ++j) {
      P_(i, j) += model_.jerk_density_m2_s5 * Q(std::min(i, j), std::max(i, j));
    }
  }
  P_(kNoise, kNoise) += (1 - phi * phi) * squared(model_.position_sd_m);
}

Innovation NoiseFilter::update(double z_m) {
  // z = H x, H = (1 0 0 1), without noise of its own
  const State PH = P_.col(kPosition) + P_.col(kNoise);
  Innovation innovation;
  innovation.variance_m2 = PH[kPosition] + PH[kNoise];
  innovation.innovation_m = z_m - x_[kPosition] - x_[kNoise];
  const State K = PH / innovation.variance_m2;
  x_ += K * innovation.innovation_m;
  P_ -= K * PH.transpose();
  return innovation;
}

}  // namespace condyle::host
