// SPDX-License-Identifier: Apache-2.0
// The recursions against solutions found in another way.
#include "evaluation/cramer_rao.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>
#include <vector>

#include "consistency/linear_gaussian_toy.h"
#include "support/random.h"

namespace condyle::host {
namespace {

using testing_support::Random;

// Largest difference in units of the standard deviations of `expected`.
template <class Matrix>
double relative_difference(const Matrix& actual, const Matrix& expected) {
  const auto unit = expected.diagonal().cwiseSqrt().cwiseInverse().eval();
  return (unit.asDiagonal() * (actual - expected) * unit.asDiagonal()).cwiseAbs().maxCoeff();
}

// Covariance after the update from the stable eigenvectors of the symplectic matrix of the filter's
// Riccati equation (Vaughan 1970), no recursion.
Eigen::Matrix3d steady_state_covariance(const ToySystem& system) {
  const double T = system.sample_time_s, R = std::pow(system.position_noise_m, 2);
  // In units of R, T: entries of like size.
  const Eigen::Vector3d unit = std::sqrt(R) * Eigen::Vector3d(1, 1 / T, 1 / (T * T));
  const Eigen::Matrix3d to_units = unit.cwiseInverse().asDiagonal();
  const Eigen::Matrix3d F = to_units * system.transition() * unit.asDiagonal();
  const Eigen::Matrix3d Q = to_units * system.process_covariance() * to_units;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information(0, 0) = 1;

  const Eigen::Matrix3d F_inverse = F.inverse();
  Eigen::Matrix<double, 6, 6> symplectic;
  symplectic << F.transpose() + information * F_inverse * Q, -information * F_inverse,
      -F_inverse * Q, F_inverse;
  const Eigen::EigenSolver<Eigen::Matrix<double, 6, 6>> solver(symplectic);
  Eigen::Matrix<std::complex<double>, 6, 3> stable;
  int column = 0;
  for (int i = 0; i < 6; ++i) {
    if (std::abs(solver.eigenvalues()[i]) < 1 && column < 3) {
      stable.col(column++) = solver.eigenvectors().col(i);
    }
  }
  EXPECT_EQ(column, 3);
  const Eigen::Matrix3d predicted = (stable.bottomRows<3>() * stable.topRows<3>().inverse()).real();
  const Eigen::Matrix3d updated =
      predicted - predicted.col(0) * predicted.row(0) / (predicted(0, 0) + 1);
  return unit.asDiagonal() * updated * unit.asDiagonal();
}

TEST(CramerRao, SettlesAtTheSolutionOfTheRiccatiEquation) {
  for (const double density : {1.0, 10.0, 1000.0}) {
    ToySystem system;
    system.jerk_density_m2_s5 = density;
    system.steps = 1000;
    EXPECT_LT(relative_difference(toy_bound(system), steady_state_covariance(system)), 1e-9);
  }
}

TEST(CramerRao, BothFormsAgreeForALinearSystem) {
  const ToySystem system;
  const auto step = toy_bound_step(system);
  Eigen::Matrix3d P = system.initial_covariance(), J = P.inverse();
  for (int k = 0; k < 200; ++k) {
    P = step.advance_covariance(P);
    J = step.advance_information(J).value();
    EXPECT_LT(relative_difference(Eigen::Matrix3d(J.inverse()), P), 1e-8) << k;
  }
}

// Jacobians that differ between trajectories.
struct RandomSteps {
  static constexpr int kSteps = 6;
  Eigen::Matrix2d Q{{0.5, 0.1}, {0.1, 0.3}}, J0{{2, 0.3}, {0.3, 1}};
  std::vector<BoundStep<2, 1>> steps;
  Eigen::Matrix2d mean_F[kSteps], mean_FQF[kSteps], mean_HRH[kSteps];

  RandomSteps() : steps(kSteps, {Q, Eigen::Matrix<double, 1, 1>(0.2)}) {
    constexpr int kTrajectories = 20;
    Random random(11);
    for (std::size_t k = 0; k < kSteps; ++k) {
      mean_F[k] = mean_FQF[k] = mean_HRH[k] = Eigen::Matrix2d::Zero();
      for (int i = 0; i < kTrajectories; ++i) {
        Eigen::Matrix2d F;
        for (double& entry : F.reshaped()) entry = random.normal();
        const Eigen::RowVector2d H(random.normal(), random.uniform());
        steps[k].add(F, H);
        mean_F[k] += F / kTrajectories;
        mean_FQF[k] += F.transpose() * Q.inverse() * F / kTrajectories;
        mean_HRH[k] += H.transpose() * H / (0.2 * kTrajectories);
      }
    }
  }
};

TEST(CramerRao, InformationFormIsTheJointInformationOfTheWholeTrajectory) {
  const RandomSteps random;
  constexpr int kStates = 2 * (RandomSteps::kSteps + 1);
  Eigen::Matrix<double, kStates, kStates> joint;  // of x_0 ... x_6 together
  joint.setZero();
  joint.topLeftCorner<2, 2>() = random.J0;
  const Eigen::Matrix2d Q_inverse = random.Q.inverse();
  Eigen::Matrix2d J = random.J0;
  for (int k = 0; k < RandomSteps::kSteps; ++k) {
    const int here = 2 * k, next = here + 2;
    const Eigen::Matrix2d D12 = -random.mean_F[k].transpose() * Q_inverse;
    joint.block<2, 2>(here, here) += random.mean_FQF[k];
    joint.block<2, 2>(here, next) = D12;
    joint.block<2, 2>(next, here) = D12.transpose();
    joint.block<2, 2>(next, next) = Q_inverse + random.mean_HRH[k];
    J = random.steps[static_cast<std::size_t>(k)].advance_information(J).value();
  }
  const Eigen::Matrix2d expected = joint.inverse().bottomRightCorner<2, 2>();
  EXPECT_LT(relative_difference(Eigen::Matrix2d(J.inverse()), expected), 1e-12);
}

TEST(CramerRao, CovarianceFormIsNoBoundWhereTheJacobiansVary) {
  const RandomSteps random;
  Eigen::Matrix2d J = random.J0, P = J.inverse();
  for (const auto& step : random.steps) {
    J = step.advance_information(J).value();
    P = step.advance_covariance(P);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> excess(P - J.inverse());
    EXPECT_GT(excess.eigenvalues()[0], 0);
  }
}

TEST(CramerRao, MergedTrajectoriesAreTheWhole) {
  const Eigen::Matrix2d Q = Eigen::Matrix2d::Identity(), F{{1, 2}, {0, 1}};
  const Eigen::Matrix<double, 1, 1> R(2);
  BoundStep<2, 1> whole(Q, R), first(Q, R), second(Q, R);
  whole.add(F, {1, 0});
  first.add(F, {1, 0});
  whole.add(2 * F, {0, 3});
  second.add(2 * F, {0, 3});
  first.merge(second);
  EXPECT_EQ(first.trajectories(), 2U);
  EXPECT_EQ(first.advance_covariance(Q), whole.advance_covariance(Q));
  EXPECT_EQ(first.advance_information(Q), whole.advance_information(Q));
}

// A constant speed to be learnt: Q = 0, the bound is that of least squares.
TEST(CramerRao, CovarianceFormHandlesConstantParameters) {
  const double R = 0.04;
  Eigen::Matrix2d F;
  F << 1, 0.1, 0, 1;
  BoundStep<2, 1> step(Eigen::Matrix2d::Zero(), Eigen::Matrix<double, 1, 1>(R));
  step.add(F, {1, 0});
  EXPECT_FALSE(step.has_information_form());
  EXPECT_EQ(step.advance_information(Eigen::Matrix2d::Identity()), std::nullopt);

  Eigen::Matrix2d P = Eigen::Vector2d(1, 4).asDiagonal();
  Eigen::Matrix2d initial_information = P.inverse(), from_start = Eigen::Matrix2d::Identity();
  for (int k = 0; k < 50; ++k) {
    P = step.advance_covariance(P);
    from_start = F * from_start;
    const Eigen::RowVector2d H = from_start.row(0);
    initial_information += H.transpose() * H / R;
  }
  const Eigen::Matrix2d expected =
      from_start * initial_information.inverse() * from_start.transpose();
  EXPECT_LT(relative_difference(P, expected), 1e-11);

  // A speed known exactly stays so.
  P = Eigen::Vector2d(1, 0).asDiagonal();
  for (int k = 0; k < 50; ++k) P = step.advance_covariance(P);
  EXPECT_NEAR(P(0, 0), 1 / (1 + 50 / R), 1e-15);
  EXPECT_EQ(P(1, 1), 0);
}

TEST(CramerRao, TellsASingularProcessNoiseFromASmallOne) {
  const Eigen::Matrix<double, 1, 1> R(1);
  const Eigen::Vector3d direction(0.1, 0.7, 0.3);
  const Eigen::Matrix3d along = direction * direction.transpose();
  EXPECT_FALSE((BoundStep<3, 1>(along, R).has_information_form()));
  EXPECT_TRUE(
      (BoundStep<3, 1>(1e-30 * ToySystem().process_covariance(), R).has_information_form()));
}

TEST(CramerRao, ALostMeasurementTellsNothing) {
  const ToySystem system;
  BoundStep<3, 1> lost(system.process_covariance(), Eigen::Matrix<double, 1, 1>(1e-8));
  lost.add(system.transition(), Eigen::RowVector3d::Zero());
  const Eigen::Matrix3d P = system.initial_covariance(), F = system.transition();
  const Eigen::Matrix3d expected = F * P * F.transpose() + system.process_covariance();
  EXPECT_LT(relative_difference(lost.advance_covariance(P), expected), 1e-14);
}

}  // namespace
}  // namespace condyle::host
