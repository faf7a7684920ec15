// SPDX-License-Identifier: Apache-2.0
// The motion of a relaxed jaw after it is let go, and the information in its positions.
//
//   p        position (m); t: time since the first sample (s)
//   lambda   kv / m, rate of damping (1/s)
//   kappa    ks / m, stiffness per mass (1/s^2)
//   r        rest, where support and weight balance (m)
//   p0, v0   position (m) and velocity (m/s) at the first sample
//   zeta     lambda / (2 sqrt kappa), damping ratio; omega = sqrt kappa, natural frequency (rad/s)
//   C, S     position after t for one unit of p0 - r, of v0
//
// Model:          p'' = -lambda p' - kappa (p - r)
// Solution:       p = r (1 - C) + p0 C + v0 S, with a = lambda / 2, x = (kappa - a^2) t^2,
//                 S = e^(-a t) t sin(sqrt x) / sqrt x, C = e^(-a t) cos(sqrt x) + a S: functions of
//                 x that are smooth through critical damping, x = 0, and hyperbolic below
// Sensitivities:  dp/dr = 1 - C, dp/dp0 = C, dp/dv0 = S,
//                 dp/dlambda = (p0 - r) dC/dlambda + v0 dS/dlambda, likewise kappa
//
// The rows (1 - C, C, S, dC/dlambda, dS/dlambda, dC/dkappa, dS/dkappa, z) of all samples are turned
// into one 8 x 8 triangle with the same inner products, so that no memory grows with the recording.
// p is linear in r, p0 and v0: below their three rows the triangle holds what they cannot explain
// (variable projection; G. H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413-432).
#pragma once

#include <span>

#include "condyle/estimator/math/elementary.h"
#include "condyle/estimator/provenance.h"

namespace condyle {

/// Rates of a release; see above.
template <class Scalar>
struct ReleaseRates {
  Scalar lambda = 0, kappa = 0;
};

/// The unknowns of a release, in the order of its covariance.
enum ReleaseUnknown {
  kReleaseLambda,
  kReleaseKappa,
  kReleaseRest,
  kReleaseStart,
  kReleaseVelocity,
  kReleaseUnknowns
};

/// Covariance of the unknowns; zero where one is known.
template <class Scalar>
using ReleaseCovariance = Eigen::Matrix<Scalar, kReleaseUnknowns, kReleaseUnknowns>;

/// Rows with the same inner products as all rows added, by Givens rotations: the triangle R of QR.
template <class Scalar, int size>
class RowTriangle {
 public:
  using Row = Eigen::Matrix<Scalar, 1, size>;

  /// Adds a row.
  void add(Row row) {
    using std::sqrt;
    for (int i = 0; i < size; ++i) {
      if (row[i] == Scalar(0)) continue;
      const Scalar length = sqrt(R_(i, i) * R_(i, i) + row[i] * row[i]);
      if (length == Scalar(0)) continue;
      const Scalar c = R_(i, i) / length, s = row[i] / length;
      for (int j = i; j < size; ++j) {
        const Scalar above = R_(i, j);
        R_(i, j) = c * above + s * row[j];
        row[j] = c * row[j] - s * above;
      }
    }
  }
  /// R, upper triangular.
  const Eigen::Matrix<Scalar, size, size>& rows() const { return R_; }

 private:
  Eigen::Matrix<Scalar, size, size> R_ = Eigen::Matrix<Scalar, size, size>::Zero();
};

/// C and S after a time, and their derivatives with respect to lambda and kappa.
template <class Scalar>
struct ReleaseResponse {
  Scalar C = 1, S = 0;
  Scalar C_of_lambda = 0, S_of_lambda = 0, C_of_kappa = 0, S_of_kappa = 0;
};

namespace internal {

/// e^(-d) times c(x) = cos sqrt x, s(x) = sin(sqrt x) / sqrt x and ds/dx, which are smooth at 0 and
/// hyperbolic below; dc/dx = -s / 2.
template <class Scalar>
struct DampedWave {
  Scalar c, s, s_of_x;
};

template <class Scalar>
DampedWave<Scalar> damped_wave(Scalar d, Scalar x) {
  using std::sqrt;
  const Scalar decay = elementary::exp(-d);
  if (x < Scalar(1) && x > Scalar(-1)) {
    DampedWave<Scalar> wave{0, 0, 0};
    Scalar term = decay;  // (-x)^k / (2k)! e^-d
    for (int k = 0; k < 11; ++k) {
      const Scalar odd = Scalar(2 * k + 1);
      wave.c += term;
      wave.s += term / odd;
      const Scalar next = -term / (odd * Scalar(2 * k + 2));
      wave.s_of_x += next * Scalar(k + 1) / Scalar(2 * k + 3);
      term = next * x;
    }
    return wave;
  }
  const Scalar root = sqrt(x > Scalar(0) ? x : -x);
  DampedWave<Scalar> wave{};
  if (x > Scalar(0)) {
    wave.c = decay * elementary::cos(root);
    wave.s = decay * elementary::sin(root) / root;
  } else {  // the two exponents apart: each alone may leave the range of numbers
    const Scalar slow = elementary::exp(root - d);
    const Scalar fast = elementary::exp(-root - d);
    wave.c = (slow + fast) / Scalar(2);
    wave.s = (slow - fast) / (Scalar(2) * root);
  }
  wave.s_of_x = (wave.c - wave.s) / (Scalar(2) * x);
  return wave;
}

}  // namespace internal

/// C, S and their derivatives `t` s after the first sample.
template <class Scalar>
ReleaseResponse<Scalar> release_response(const ReleaseRates<Scalar>& rates, Scalar t) {
  const Scalar a = rates.lambda / Scalar(2), d = a * t, tt = t * t;
  const auto wave = internal::damped_wave(d, (rates.kappa - a * a) * tt);
  ReleaseResponse<Scalar> response;
  response.C = wave.c + d * wave.s;
  response.S = t * wave.s;
  const Scalar C_of_x = d * wave.s_of_x - wave.s / Scalar(2), S_of_x = t * wave.s_of_x;
  response.C_of_kappa = C_of_x * tt;  // x = (kappa - lambda^2 / 4) t^2
  response.S_of_kappa = S_of_x * tt;
  response.C_of_lambda = (t * wave.s - t * response.C) / Scalar(2) - a * response.C_of_kappa;
  response.S_of_lambda = -t * response.S / Scalar(2) - a * response.S_of_kappa;
  return response;
}

/// Fit of all positions of a release at given rates: the best r, p0 and v0, and the residual.
template <class Scalar>
struct ReleaseEquations {
  static constexpr int kLinear = 3, kLeft = 5;

  Eigen::Matrix<Scalar, kLinear, 1> linear = Eigen::Matrix<Scalar, kLinear, 1>::Zero();
  Eigen::Matrix<Scalar, kLeft, 1> residual = Eigen::Matrix<Scalar, kLeft, 1>::Zero();
  /// -d residual / d(lambda, kappa), without the part that r, p0 and v0 explain.
  Eigen::Matrix<Scalar, kLeft, 2> slope = Eigen::Matrix<Scalar, kLeft, 2>::Zero();

  /// Sum of squared residuals (m^2).
  Scalar square_sum() const { return residual.squaredNorm(); }
};

namespace internal {

/// Inverse of the upper triangle `U` in its first `used` rows and columns, zero beyond.
template <class Scalar, int size>
Eigen::Matrix<Scalar, size, size> inverse_of_triangle(const Eigen::Matrix<Scalar, size, size>& U,
                                                      int used) {
  Eigen::Matrix<Scalar, size, size> inverse = Eigen::Matrix<Scalar, size, size>::Zero();
  for (int column = 0; column < used; ++column) {
    for (int i = column; i >= 0; --i) {
      Scalar sum = i == column ? Scalar(1) : Scalar(0);
      for (int j = i + 1; j <= column; ++j) sum -= U(i, j) * inverse(j, column);
      inverse(i, column) = sum / U(i, i);
    }
  }
  return inverse;
}

/// The triangle of the header comment. `position_of(i)`: measured, or 0.
template <class Scalar, class PositionOf>
Eigen::Matrix<Scalar, 8, 8> release_triangle(std::span<const Scalar> time_s,
                                             const PositionOf& position_of,
                                             const ReleaseRates<Scalar>& rates,
                                             bool starts_at_rest) {
  RowTriangle<Scalar, 8> triangle;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const auto at = release_response(rates, time_s[i] - time_s[0]);
    typename RowTriangle<Scalar, 8>::Row row;
    row << Scalar(1) - at.C, at.C, starts_at_rest ? Scalar(0) : at.S, at.C_of_lambda,
        at.S_of_lambda, at.C_of_kappa, at.S_of_kappa, position_of(i);
    triangle.add(row);
  }
  return triangle.rows();
}

}  // namespace internal

/// The equations of positions `position_m` at `time_s` (same size, times increasing) at `rates`.
/// `starts_at_rest`: v0 is known to be 0. Not finite if r and p0 cannot be separated.
template <class Scalar>
ReleaseEquations<Scalar> release_equations(std::span<const Scalar> time_s,
                                           std::span<const Scalar> position_m,
                                           const ReleaseRates<Scalar>& rates, bool starts_at_rest) {
  const Scalar origin = position_m[0];  // so that a distant origin costs no digits
  const auto R = internal::release_triangle(
      time_s, [&](std::size_t i) { return position_m[i] - origin; }, rates, starts_at_rest);
  ReleaseEquations<Scalar> equations;
  auto& x = equations.linear;
  if (!starts_at_rest) x[2] = R(2, 7) / R(2, 2);
  x[1] = (R(1, 7) - R(1, 2) * x[2]) / R(1, 1);
  x[0] = (R(0, 7) - R(0, 1) * x[1] - R(0, 2) * x[2]) / R(0, 0);
  const Scalar opening = x[1] - x[0];
  equations.residual = R.template block<5, 1>(3, 7);
  equations.slope.col(0) =
      R.template block<5, 1>(3, 3) * opening + R.template block<5, 1>(3, 4) * x[2];
  equations.slope.col(1) =
      R.template block<5, 1>(3, 5) * opening + R.template block<5, 1>(3, 6) * x[2];
  x[0] += origin;
  x[1] += origin;
  return equations;
}

/// The Cramer-Rao bound: no unbiased estimator from positions at `time_s` (increasing) with white
/// noise of `noise_sd_m` has a smaller covariance of (lambda, kappa, r, p0, v0). `opening_m`: p0 -
/// r; `velocity_m_s`: v0, known to be 0 if `starts_at_rest`. NaN or infinite if a value cannot be
/// determined.
template <class Scalar>
ReleaseCovariance<Scalar> release_bound(std::span<const Scalar> time_s,
                                        const ReleaseRates<Scalar>& rates, Scalar opening_m,
                                        Scalar velocity_m_s, Scalar noise_sd_m,
                                        bool starts_at_rest) {
  const auto R = internal::release_triangle(
      time_s, [](std::size_t) { return Scalar(0); }, rates, starts_at_rest);
  RowTriangle<Scalar, kReleaseUnknowns> information;
  for (int i = 0; i < 7; ++i) {
    typename RowTriangle<Scalar, kReleaseUnknowns>::Row row;
    row << opening_m * R(i, 3) + velocity_m_s * R(i, 4),
        opening_m * R(i, 5) + velocity_m_s * R(i, 6), R(i, 0), R(i, 1), R(i, 2);
    information.add(row);
  }
  const ReleaseCovariance<Scalar> inverse = internal::inverse_of_triangle<Scalar, kReleaseUnknowns>(
      information.rows(), starts_at_rest ? kReleaseUnknowns - 1 : kReleaseUnknowns);
  return noise_sd_m * noise_sd_m * inverse * inverse.transpose();
}

/// Standard deviations from a covariance of (lambda, kappa), by the delta method.
template <class Scalar>
struct ReleaseDeviations {
  Scalar damping_rate_per_s = 0, stiffness_per_mass_per_s2 = 0, damping_ratio = 0,
         natural_frequency_rad_s = 0;
};

template <class Scalar>
ReleaseDeviations<Scalar> release_deviations(const ReleaseCovariance<Scalar>& covariance,
                                             const ReleaseRates<Scalar>& rates) {
  using std::sqrt;
  const Scalar omega = sqrt(rates.kappa);
  const Scalar of_lambda = Scalar(1) / (Scalar(2) * omega);
  const Scalar of_kappa = -rates.lambda / (Scalar(4) * omega * rates.kappa);
  const Scalar ll = covariance(kReleaseLambda, kReleaseLambda);
  const Scalar lk = covariance(kReleaseLambda, kReleaseKappa);
  const Scalar kk = covariance(kReleaseKappa, kReleaseKappa);
  return {sqrt(ll), sqrt(kk),
          sqrt(of_lambda * of_lambda * ll + Scalar(2) * of_lambda * of_kappa * lk +
               of_kappa * of_kappa * kk),
          sqrt(kk) / (Scalar(2) * omega)};
}

}  // namespace condyle
