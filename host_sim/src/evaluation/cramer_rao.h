// SPDX-License-Identifier: Apache-2.0
// Posterior Cramer-Rao bound: the smallest error covariance that any estimator can have. It
// measures how much of the information a filter uses.
//
//   x_{k+1} = f_k(x_k) + w_k,   w_k ~ N(0, Q)   n states; w and r independent of all else
//   z_k     = h_k(x_k) + r_k,   r_k ~ N(0, R)   m measurements
//   F   Jacobian of f_k at the true x_k, n x n
//   H   Jacobian of h_{k+1} at the true x_{k+1}, m x n
//   E   average over Monte-Carlo trajectories of the true state
//   J   posterior information of x_k; J_0 is that of the prior, plus E[H' R^-1 H] if there is a z_0
//   P   J^-1, the bound: E[e e'] - P is positive semidefinite for every estimate of x_k from the
//       measurements up to z_k, also for one that is biased
//   M   E[H' R^-1 H]
//
// Information form: Tichavsky, Muravchik and Nehorai (1998), Posterior Cramer-Rao bounds for
// discrete-time nonlinear filtering, IEEE Trans. Signal Processing 46(5), 1386-1396.
//   D11 = E[F' Q^-1 F]    D12 = -E[F'] Q^-1 = D21'    D22 = Q^-1 + M
//   J_{k+1} = D22 - D21 (J_k + D11)^-1 D12
// It holds for every smooth f and h, but needs Q positive definite: every state must be driven.
//
// Covariance form, also if Q is singular (constant parameters) or zero:
//   P- = E[F] P_k E[F]' + Q      P_{k+1} = (I + P- M)^-1 P-
// which is J_{k+1} = (P-)^-1 + M wherever P- has an inverse.
//
// The two agree, by the matrix inversion lemma, if Q is positive definite and F is the same along
// all trajectories: dynamics linear in the whole state, or one prescribed trajectory. If F varies,
// D11 exceeds E[F]' Q^-1 E[F]; the information form then gives the smaller P, and the covariance
// form is an approximation, not a bound. In this case run it along each trajectory separately,
// which gives the covariance of a Kalman filter linearised at the truth, and average P over the
// trajectories: for Q = 0 and a flat prior this is the Cramer-Rao bound of unbiased estimates,
// otherwise close to it while the errors are small. A small Q added to make the information form
// work describes another model and a loose bound: the variation of F, divided by Q, counts as
// information.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <cstdint>
#include <optional>

#include "statistics/chi_square.h"

namespace condyle::host {

/// One step of the bound, from k to k + 1. Units follow the states and measurements.
template <int n, int m>
class BoundStep {
 public:
  using StateMatrix = Eigen::Matrix<double, n, n>;
  using MeasurementJacobian = Eigen::Matrix<double, m, n>;
  using MeasurementMatrix = Eigen::Matrix<double, m, m>;

  /// `Q` positive semidefinite, `R` positive definite: the same for all trajectories.
  BoundStep(const StateMatrix& Q, const MeasurementMatrix& R) : Q_(Q), R_factor_(R), Q_factor_(Q) {}

  /// Adds the Jacobians along one more trajectory. A lost measurement has `H` = 0.
  void add(const StateMatrix& F, const MeasurementJacobian& H) {
    sum_F_ += F;
    if (has_information_form()) {
      sum_FQF_ += Q_factor_.matrixL().solve(F).transpose() * Q_factor_.matrixL().solve(F);
    }
    sum_HRH_ += H.transpose() * R_factor_.solve(H);
    ++trajectories_;
  }

  /// Appends the trajectories of `later`, of the same step.
  void merge(const BoundStep& later) {
    sum_F_ += later.sum_F_;
    sum_FQF_ += later.sum_FQF_;
    sum_HRH_ += later.sum_HRH_;
    trajectories_ += later.trajectories_;
  }

  std::uint64_t trajectories() const { return trajectories_; }
  /// E[H' R^-1 H], the information of the measurement at k + 1 alone.
  StateMatrix measurement_information() const { return sum_HRH_ / count(); }

  /// Is Q positive definite?
  bool has_information_form() const {
    if (Q_factor_.info() != Eigen::Success) return false;
    // The remainder of each variance given the previous states: a remainder within rounding counts
    // as zero.
    const auto left = Q_factor_.matrixLLT().diagonal().cwiseAbs2().eval();
    return (left.array() > 1e-12 * Q_.diagonal().array()).all();
  }

  /// J_{k+1} from J_k. Empty if Q is singular.
  std::optional<StateMatrix> advance_information(const StateMatrix& J) const {
    if (!has_information_form()) return std::nullopt;
    const StateMatrix D12 = -Q_factor_.solve(StateMatrix(sum_F_ / count())).transpose();
    const Eigen::LLT<StateMatrix> inner(J + sum_FQF_ / count());
    const StateMatrix next = Q_factor_.solve(StateMatrix::Identity()) + measurement_information() -
                             D12.transpose() * inner.solve(D12);
    return StateMatrix((next + next.transpose()) / 2);
  }

  /// P_{k+1} from P_k, also if either is singular.
  StateMatrix advance_covariance(const StateMatrix& P) const {
    const StateMatrix F = sum_F_ / count();
    const StateMatrix predicted = F * P * F.transpose() + Q_;
    // In units of the standard deviations: metres and newtons differ by orders of magnitude.
    Eigen::Matrix<double, n, 1> unit = predicted.diagonal().cwiseSqrt();
    for (double& one : unit) one = one > 0 ? one : 1;
    const StateMatrix scaled =
        unit.cwiseInverse().asDiagonal() * predicted * unit.cwiseInverse().asDiagonal();
    const StateMatrix information =
        unit.asDiagonal() * measurement_information() * unit.asDiagonal();
    const StateMatrix updated =
        Eigen::FullPivLU<StateMatrix>(StateMatrix::Identity() + scaled * information).solve(scaled);
    const StateMatrix next = unit.asDiagonal() * updated * unit.asDiagonal();
    return (next + next.transpose()) / 2;
  }

 private:
  double count() const { return static_cast<double>(trajectories_); }

  StateMatrix Q_;
  Eigen::LLT<MeasurementMatrix> R_factor_;
  Eigen::LLT<StateMatrix> Q_factor_;
  StateMatrix sum_F_ = StateMatrix::Zero();
  StateMatrix sum_FQF_ = StateMatrix::Zero();
  StateMatrix sum_HRH_ = StateMatrix::Zero();
  std::uint64_t trajectories_ = 0;
};

/// Error rms over the bound: 1 for an estimator that uses all information. `bound_variance`: the
/// entry of P, its mean over the same samples as the rms.
inline double ratio_to_bound(double error_rms, double bound_variance) {
  return error_rms / std::sqrt(bound_variance);
}

/// Range of the ratio for an estimator at the bound with normal errors, one sample in each run.
inline Interval ratio_to_bound_bounds(std::uint64_t runs, double confidence) {
  const Interval square = mean_chi_square_bounds(1, runs, confidence);
  return {std::sqrt(square.low), std::sqrt(square.high)};
}

}  // namespace condyle::host
