// SPDX-License-Identifier: Apache-2.0
#include "consistency/linear_gaussian_toy.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace condyle::host {
namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

Vector draw(const Matrix& covariance, const std::function<double()>& normal) {
  Vector white;
  for (double& one : white) one = normal();
  return Eigen::LLT<Matrix>(covariance).matrixL() * white;
}

}  // namespace

Matrix ToySystem::transition() const {
  const double T = sample_time_s;
  Matrix F;
  F << 1, T, T * T / 2, 0, 1, T, 0, 0, 1;
  return F;
}

Matrix ToySystem::process_covariance() const {
  const double T = sample_time_s, T2 = T * T, T3 = T2 * T;
  Matrix Q;
  Q << T3 * T2 / 20, T2 * T2 / 8, T3 / 6, T2 * T2 / 8, T3 / 3, T2 / 2, T3 / 6, T2 / 2, T;
  return jerk_density_m2_s5 * Q;
}

Matrix ToySystem::initial_covariance() const {
  return initial_sd.cwiseAbs2().asDiagonal();
}

ToyRun run_toy(const ToySystem& system, const ToySpoilt& spoilt,
               const std::function<double()>& normal) {
  const Matrix F = system.transition(), true_Q = system.process_covariance();
  const Matrix Q = spoilt.claimed_jerk_density * true_Q;
  const double R = std::pow(spoilt.claimed_position_noise * system.position_noise_m, 2);

  ToyRun run;
  Matrix P = system.initial_covariance();
  Vector truth = draw(P, normal), x = Vector::Zero();
  for (int step = 1; step <= system.steps; ++step) {
    truth = F * truth + draw(true_Q, normal);
    const double z = truth[0] + system.position_noise_m * normal() + spoilt.sensor_bias_m;

    x = F * x;
    P = F * P * F.transpose() + Q;
    const double S = P(0, 0) + R, innovation = z - x[0];
    run.nis.add(innovation * innovation / S);
    const Vector K = P.col(0) / S;
    x += K * innovation;
    Matrix I_KH = Matrix::Identity();
    I_KH.col(0) -= K;
    P = I_KH * P * I_KH.transpose() + K * R * K.transpose();  // Joseph

    const Vector error = x - truth, sd = P.diagonal().cwiseSqrt();
    const double nees = normalised_square<3>(error, P);
    run.nees.add(nees);
    run.position_m.add(error[0], sd[0]);
    run.velocity_m_s.add(error[1], sd[1]);
    run.acceleration_m_s2.add(error[2], sd[2]);
    if (step < system.steps) continue;
    run.last_nees.add(nees);
    run.last_position_m.add(error[0], sd[0]);
    run.last_velocity_m_s.add(error[1], sd[1]);
    run.last_acceleration_m_s2.add(error[2], sd[2]);
  }
  return run;
}

void ToyStatistics::add_run(const ToyRun& run) {
  position_m.add_run(run.position_m);
  velocity_m_s.add_run(run.velocity_m_s);
  acceleration_m_s2.add_run(run.acceleration_m_s2);
  last_position_m.add_run(run.last_position_m);
  last_velocity_m_s.add_run(run.last_velocity_m_s);
  last_acceleration_m_s2.add_run(run.last_acceleration_m_s2);
  nees.add_run(run.nees);
  last_nees.add_run(run.last_nees);
  nis.add_run(run.nis);
}

BoundStep<3, 1> toy_bound_step(const ToySystem& system) {
  using Scalar = Eigen::Matrix<double, 1, 1>;
  BoundStep<3, 1> step(system.process_covariance(),
                       Scalar(system.position_noise_m * system.position_noise_m));
  step.add(system.transition(), Eigen::RowVector3d(1, 0, 0));
  return step;
}

Matrix toy_bound(const ToySystem& system) {
  const auto step = toy_bound_step(system);
  Matrix P = system.initial_covariance();
  for (int k = 0; k < system.steps; ++k) P = step.advance_covariance(P);
  return P;
}

}  // namespace condyle::host
