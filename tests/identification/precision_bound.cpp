// SPDX-License-Identifier: Apache-2.0
#include "identification/precision_bound.h"

#include <Eigen/Dense>
#include <cmath>

namespace condyle::adversary {

PrecisionBound precision_bound(const Regime& regime, std::uint64_t seed) {
  const Point& point = regime.point;
  const double T = 1e-3;  // of the columns, which are free of noise
  const double z2 = std::pow(regime.tracker.noise_m, 2) / regime.tracker.rate_Hz,
               u2 = std::pow(regime.drive.noise_N, 2) / regime.drive.rate_Hz;
  const double m = point.mass_kg, kv = point.friction_Ns_m, ks = point.stiffness_N_m;
  const double d0 = std::sqrt(u2 + z2 * ks * ks), d2 = std::sqrt(z2) * m;
  const double d1 = std::sqrt(std::max(0.0, 2 * d0 * d2 + z2 * (kv * kv - 2 * m * ks)));
  // d2 y'' + d1 y' + d0 y = column, by the trapezoid rule.
  const double k = 2 / T, lead = d2 * k * k + d1 * k + d0;
  const double one = 2 * (d0 - d2 * k * k), two = d2 * k * k - d1 * k + d0;
  using Columns = Eigen::Vector4d;
  Columns in1 = Columns::Zero(), in2 = in1, out1 = in1, out2 = in1;
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  for (const TruePoint& now : motion_of(regime, seed, T)) {
    const Columns in(now.acceleration_m_s2, now.velocity_m_s, now.position_m, 1);
    const Columns out = (in + 2 * in1 + in2 - one * out1 - two * out2) / lead;
    in2 = in1;
    in1 = in;
    out2 = out1;
    out1 = out;
    if (now.time_s > 1) information += T * out * out.transpose();
  }
  const Eigen::Matrix4d covariance = information.inverse();
  return {std::sqrt(covariance(1, 1)), std::sqrt(covariance(0, 0))};
}

}  // namespace condyle::adversary
