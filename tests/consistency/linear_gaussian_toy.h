// SPDX-License-Identifier: Apache-2.0
// A system whose right answers are known, to test the statistics that judge filters.
//
//   x = (p, v, a)   position, velocity, acceleration; constant acceleration + white jerk
//   x' = F x + w,   w ~ N(0, Q)             F = | 1 T T^2/2 |         | T^5/20 T^4/8 T^3/6 |
//   z  = p + r + b, r ~ N(0, R)                 | 0 1 T     |   Q = q | T^4/8  T^3/3 T^2/2 |
//   x_0 ~ N(0, P0), no measurement at 0         | 0 0 1     |         | T^3/6  T^2/2 T     |
//
// and its exact Kalman filter, which for b = 0 and the true q and R meets the Cramer-Rao bound. It
// can be spoilt: told a wrong R or q, or given a sensor with bias b it does not know of.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "evaluation/consistency.h"
#include "evaluation/cramer_rao.h"
#include "evaluation/error_statistics.h"
#include "statistics/random_source.h"

namespace condyle::host {

/// The system as it is. The defaults resemble chewing seen by an optical tracker.
struct ToySystem {
  double sample_time_s = 1.0 / 60;
  double jerk_density_m2_s5 = 10;             ///< q, two-sided
  double position_noise_m = 1e-4;             ///< sqrt(R)
  Eigen::Vector3d initial_sd{5e-3, 5e-2, 1};  ///< m, m/s, m/s^2
  int steps = 60;

  Eigen::Matrix3d transition() const;
  Eigen::Matrix3d process_covariance() const;
  Eigen::Matrix3d initial_covariance() const;
};

/// What the filter is told wrongly.
struct ToySpoilt {
  double claimed_position_noise = 1;  ///< claimed sqrt(R) / true
  double claimed_jerk_density = 1;    ///< claimed q / true
  double sensor_bias_m = 0;
};

/// One run. NEES and errors of all steps and of the last alone, which is independent between runs.
struct ToyRun {
  RunErrors position_m, velocity_m_s, acceleration_m_s2;
  RunErrors last_position_m, last_velocity_m_s, last_acceleration_m_s2;
  RunSquares nees, last_nees, nis;
};

/// Simulates and filters one run with `normal`, a source of independent standard normal numbers.
ToyRun run_toy(const ToySystem& system, const ToySpoilt& spoilt,
               const std::function<double()>& normal);

/// The same with any generator.
template <RandomSource Random>
ToyRun run_toy(const ToySystem& system, const ToySpoilt& spoilt, Random& random) {
  return run_toy(system, spoilt, std::function<double()>([&random] { return random.normal(); }));
}

/// Many runs.
struct ToyStatistics {
  ErrorStatistics position_m, velocity_m_s, acceleration_m_s2;
  ErrorStatistics last_position_m, last_velocity_m_s, last_acceleration_m_s2;
  ConsistencyStatistics nees{3, ConsistencyStatistics::Independent::runs};
  ConsistencyStatistics last_nees{3, ConsistencyStatistics::Independent::runs};
  ConsistencyStatistics nis{1, ConsistencyStatistics::Independent::terms};

  void add_run(const ToyRun& run);
};

/// One step of the toy's Cramer-Rao bound, the same at all times.
BoundStep<3, 1> toy_bound_step(const ToySystem& system);

/// The bound's covariance after the last step.
Eigen::Matrix3d toy_bound(const ToySystem& system);

}  // namespace condyle::host
