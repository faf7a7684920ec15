// SPDX-License-Identifier: Apache-2.0
// The published cascade a second time, as a textbook writes it with Eigen: full 3x3 matrices, both
// measurements of a stage taken together, (I - K H) P, analytic Jacobians. It shares only the
// parameters with the estimator.
//
// Prediction:  x <- f(x),  P <- J P J' + Q
// Update:      S = H P H' + R,  K = P H' S^-1,  x <- x + K (z - H x),  P <- (I - K H) P
//              NIS = (z - H x)' S^-1 (z - H x)
#pragma once

#include <Eigen/LU>
#include <limits>

#include "condyle/estimator/published/parameters.h"

namespace condyle::testing_support {

/// One stage with `measurements` (1 or 2) of its first states.
template <class Scalar, int measurements>
struct DenseStage {
  using Vector = Eigen::Matrix<Scalar, 3, 1>;
  using Matrix = Eigen::Matrix<Scalar, 3, 3>;
  using Measured = Eigen::Matrix<Scalar, measurements, 1>;
  using MeasuredSquare = Eigen::Matrix<Scalar, measurements, measurements>;

  template <class Parameters>
  DenseStage(const Parameters& parameters, const Vector& first)
      : x(first),
        P(diagonal<3>(parameters.initial_variance)),
        Q(diagonal<3>(parameters.process_variance)),
        R(diagonal<measurements>(parameters.measurement_variance)) {}

  /// Moves to `next`; `J` is its Jacobian at the state left.
  void predict(const Vector& next, const Matrix& J) {
    x = next;
    P = J * P * J.transpose() + Q;
  }

  /// Takes the measurement `z` of the first states. Returns the normalised innovation squared if
  /// requested.
  template <bool with_nis>
  Scalar update(const Measured& z) {
    const MeasuredSquare inverse_S = innovation_covariance().inverse();
    const Measured innovation = z - H * x;
    const Eigen::Matrix<Scalar, 3, measurements> K = P * H.transpose() * inverse_S;
    x += K * innovation;
    P = (Matrix::Identity() - K * H) * P;
    if constexpr (with_nis) return innovation.dot(inverse_S * innovation);
    return 0;
  }

  /// S.
  MeasuredSquare innovation_covariance() const { return H * P * H.transpose() + R; }
  /// Normalised innovation squared that `z` would have.
  Scalar nis_of(const Measured& z) const {
    const Measured innovation = z - H * x;
    return innovation.dot(innovation_covariance().inverse() * innovation);
  }

  Vector x;
  Matrix P, Q;
  MeasuredSquare R;
  Eigen::Matrix<Scalar, measurements, 3> H = Eigen::Matrix<Scalar, measurements, 3>::Identity();

 private:
  template <int n>
  static Eigen::Matrix<Scalar, n, n> diagonal(const double* entries) {
    return Eigen::Map<const Eigen::Matrix<double, n, 1>>(entries)
        .template cast<Scalar>()
        .asDiagonal();
  }
};

/// The three stages in their order.
template <class Scalar>
class DenseCascade {
 public:
  /// As CascadeCore's.
  explicit DenseCascade(const PublishedParameters& p,
                        Scalar gate = std::numeric_limits<Scalar>::infinity())
      : motion(p.motion, {0, 0, 0}),
        friction(p.friction, {0, 0, static_cast<Scalar>(p.friction.initial_Ns_m)}),
        mass(p.mass, {0, 0, static_cast<Scalar>(p.mass.initial_kg)}),
        m0_(static_cast<Scalar>(p.assumed_mass_kg)),
        backward_(p.motion.discretisation == Discretisation::backward),
        gate_(gate) {}

  /// Results of a step, of stages 1 to 3.
  struct Nis {
    Scalar motion = 0, friction = 0, mass = 0;
    bool rejected = false;
  };

  /// `T` seconds on, with the measured position `z` (m).
  template <bool with_checks>
  Nis step(Scalar z, Scalar T) {
    if (!started_) motion.x[0] = friction.x[0] = mass.x[0] = z;
    Nis nis;
    if (started_) predict_motion(T);
    if constexpr (with_checks) {
      nis.rejected = motion.nis_of(Measured1(z)) > gate_;
      if (nis.rejected) {
        predict_friction(T);
        predict_mass(T);
        return nis;
      }
    }
    nis.motion = motion.template update<with_checks>(Measured1(z));
    const Measured2 z_and_v(z, motion.x[1]);
    if (started_) predict_friction(T);
    nis.friction = friction.template update<with_checks>(z_and_v);
    if (started_) predict_mass(T);
    nis.mass = mass.template update<with_checks>(z_and_v);
    started_ = true;
    return nis;
  }

  /// Stage 1 alone, without checks.
  void step_motion(Scalar z, Scalar T) {
    if (started_) {
      predict_motion(T);
    } else {
      motion.x[0] = z;
    }
    motion.template update<false>(Measured1(z));
    started_ = true;
  }

  DenseStage<Scalar, 1> motion;    ///< p (m), v (m/s), F (N)
  DenseStage<Scalar, 2> friction;  ///< p, v, kv (Ns/m)
  DenseStage<Scalar, 2> mass;      ///< p, v, m (kg)

 private:
  using Vector = Eigen::Matrix<Scalar, 3, 1>;
  using Matrix = Eigen::Matrix<Scalar, 3, 3>;
  using Measured1 = Eigen::Matrix<Scalar, 1, 1>;
  using Measured2 = Eigen::Matrix<Scalar, 2, 1>;

  // eq (30)
  void predict_motion(Scalar T) {
    const Vector& x = motion.x;
    const Scalar v = x[1] + T * x[2] / m0_;
    Matrix J;
    J << 1, T, backward_ ? T * T / m0_ : 0,  //
        0, 1, T / m0_,                       //
        0, 0, 1;
    motion.predict({x[0] + T * (backward_ ? v : x[1]), v, x[2]}, J);
  }
  // eqs (44)-(46)
  void predict_friction(Scalar T) {
    const Vector& x = friction.x;
    const Scalar u = motion.x[2];
    const Scalar d = 1 + T * x[2] / m0_;
    const Scalar v = (x[1] + T * u / m0_) / d;
    const Scalar dv_dkv = -(x[1] + T * u / m0_) * (T / m0_) / (d * d);
    Matrix J;
    J << 1, T / d, T * dv_dkv,  //
        0, 1 / d, dv_dkv,       //
        0, 0, 1;
    friction.predict({x[0] + T * v, v, x[2]}, J);
  }
  // eqs (47)-(49)
  void predict_mass(Scalar T) {
    const Vector& x = mass.x;
    const Scalar u = motion.x[2], kv = friction.x[2], m = x[2];
    const Scalar d = m + T * kv;
    const Scalar v = (m * x[1] + T * u) / d;
    const Scalar dv_dm = T * (kv * x[1] - u) / (d * d);
    Matrix J;
    J << 1, T * m / d, T * dv_dm,  //
        0, m / d, dv_dm,           //
        0, 0, 1;
    mass.predict({x[0] + T * v, v, m}, J);
  }

  Scalar m0_;
  bool backward_;
  Scalar gate_;
  bool started_ = false;
};

}  // namespace condyle::testing_support
