// SPDX-License-Identifier: Apache-2.0
// What the noise of a measured drive biases in the parameters of a driven point, and how much it
// adds to their score so that it does not (errors in variables).
//
//   x, y      state (p, v, u0, u1) of mass_spring_damper.h, u0 and u1 the drive at the last sample
//   and at
//             the next: true, estimated by the linear filter at given parameters; d = y - x its
//             error, P its covariance
//   theta_i   lambda, eta, kappa, tau (delay of the drive beyond what was taken off; s)
//   F         transition of x within an interval of the drive; F_i its derivatives
//   W_i       dy / dtheta_i
//   r, s      innovation z - H y, its variance S = H P H' + R; K gain, H = (1 0 0 0)
//   M, C_i    E d y' and E d W_i'
//
// The filter's score for theta_i is the sum of (H W_i) r / S. Drive noise e, of variance se^2, is
// in W_i and in r alike: at the true parameters
//   E (H W_i) r = -H C_i H'
// which draws eta to zero by about (se / rms u)^2 and shifts the others, however many samples. So
//   H C_i H' r^2 / S^2
// is added, of expectation H C_i H' / S. C_i follows from y <- F y, d <- F d:
//
// Drive:       u0 <- u1, u1 <- u + e: in M, d and y of u1 are e and u + e, of variance se^2
// Prediction:  M <- F M F',               C_i <- F C_i F' + F M F_i'
// Update:      M <- (I - K H) M,          C_i <- (I - K H) C_i (I - K H)'
// Start:       M of p: R, of v: 0 (it is taken for 0, whatever it is)
//
// With this the score is the gradient of -sum r^2 / S / 2, the total least squares criterion
// (Deming 1943; Fuller 1987, Measurement Error Models, 1.3): if P starts like M and no other
// noise is, M = P, H (C_i + C_i') H' = dS / dtheta_i. There is no log S in it: the true drive has
// no distribution. Unmeasured white force is in P, so in K, but not in M: it moves x, and
// y follows, so that it makes no error of a regressor.
#pragma once

#include "condyle/estimator/impedance/mass_spring_damper.h"
#include "condyle/estimator/math/symmetric_matrix.h"

namespace condyle {

/// The recursion above, along a filter that estimates theta. Fixed size, no allocation.
template <class Scalar>
class DriveNoiseBias {
 public:
  using Matrix4 = Eigen::Matrix<Scalar, 4, 4>;

  /// Number of parameters theta.
  static constexpr int kParameters = 4;

  DriveNoiseBias() {
    for (Matrix4& C : C_) C.setZero();
  }

  /// Begins the next interval of the drive; its end was measured with this variance (N^2).
  void drive(Scalar drive_variance) {
    for (Matrix4* matrix : {&M_, &C_[0], &C_[1], &C_[2], &C_[3]}) {
      matrix->row(2) = matrix->row(3);
      matrix->col(2) = matrix->col(3);
      matrix->row(3).setZero();
      matrix->col(3).setZero();
    }
    P_.move_entry(3, 2);
    P_(3, 3) = M_(3, 3) = drive_variance;
  }

  /// The point is at a first position, with these variances of position (m^2) and velocity
  /// (m^2/s^2).
  void start(Scalar position_variance, Scalar velocity_variance) {
    for (Matrix4* matrix : {&M_, &C_[0], &C_[1], &C_[2], &C_[3]}) {
      matrix->template topRows<2>().setZero();
      matrix->template leftCols<2>().setZero();
    }
    P_.clear_entry(0);
    P_.clear_entry(1);
    P_(0, 0) = M_(0, 0) = position_variance;
    P_(1, 1) = velocity_variance;
  }

  /// `T` s within an interval of the drive of `interval_s` > 0, from its share `begin` to `end`
  /// (below 0 or above 1 with a delay), with the `response` for these rates over T; `q` is
  /// the density of white acceleration (m^2/s^3).
  void predict(const DrivenRates<Scalar>& rates, const DrivenResponse<Scalar>& response,
               Scalar begin, Scalar end, Scalar interval_s, Scalar q, Scalar T) {
    const auto transition = [=](const auto& table, Scalar eta) {
      Matrix4 F = Matrix4::Zero();
      F.template topLeftCorner<2, 2>() = table.template leftCols<2>();
      const auto before = table.col(kFromDriveBefore), after = table.col(kFromDrive);
      F.template block<2, 1>(0, 2) =
          eta * ((Scalar(1) - begin) * before + (Scalar(1) - end) * after);
      F.template block<2, 1>(0, 3) = eta * (begin * before + end * after);
      return F;
    };
    Matrix4 F = transition(response.value, rates.eta);
    F(2, 2) = F(3, 3) = Scalar(1);
    Matrix4 by_eta = transition(response.value, Scalar(1));
    by_eta.template topLeftCorner<2, 2>().setZero();
    Matrix4 by_tau = Matrix4::Zero();  // later by tau is farther by the share tau / interval_s
    by_tau.template block<2, 1>(0, 3) =
        rates.eta / interval_s *
        (response.value.col(kFromDriveBefore) + response.value.col(kFromDrive)).matrix();
    by_tau.col(2) = -by_tau.col(3);
    const Matrix4 derivatives[] = {transition(response.of_lambda, rates.eta), by_eta,
                                   transition(response.of_kappa, rates.eta), by_tau};
    const Matrix4 FM = F * M_;
    for (int i = 0; i < kParameters; ++i) {
      const Matrix4 FC = F * C_[i];
      C_[i] = FC * F.transpose() + FM * derivatives[i].transpose();
    }
    M_ = FM * F.transpose();
    const Matrix4 FP = F * P_.dense();
    for (int i = 0; i < 4; ++i) {
      for (int j = i; j < 4; ++j) P_(i, j) = FP.row(i).dot(F.row(j));
    }
    P_(0, 0) += q * T * T * T / Scalar(3);
    P_(0, 1) += q * T * T / Scalar(2);
    P_(1, 1) += q * T;
  }

  /// Uses a position. Returns its contribution to the scores of theta, for r^2 = S.
  Eigen::Matrix<Scalar, kParameters, 1> update(Scalar position_variance) {
    const Scalar S = P_(0, 0) + position_variance;
    Eigen::Matrix<Scalar, 4, 1> K;
    for (int i = 0; i < 4; ++i) K[i] = P_(i, 0) / S;
    Matrix4 kept = Matrix4::Identity();  // I - K H
    kept.col(0) -= K;
    Eigen::Matrix<Scalar, kParameters, 1> score;
    for (int i = 0; i < kParameters; ++i) {
      score[i] = C_[i](0, 0) / S;
      const Matrix4 half = kept * C_[i];
      C_[i] = half * kept.transpose();
    }
    const Matrix4 M = kept * M_;
    M_ = M;
    P_.take_off(S, K);
    return score;
  }

  /// Covariance of (p, v, u0, u1) at given parameters.
  const SymmetricMatrix<Scalar, 4>& covariance() const { return P_; }

 private:
  SymmetricMatrix<Scalar, 4> P_;
  Matrix4 M_ = Matrix4::Zero();
  Array<Matrix4, kParameters> C_;
};

}  // namespace condyle
