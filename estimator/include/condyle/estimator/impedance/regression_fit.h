// SPDX-License-Identifier: Apache-2.0
// Least squares of the drive on some columns, with the columns' noise removed and intervals from
// the scatter of blocks. In double.
//
//   y          the columns of the fit; -u' for the drive's delay tau
//   M_b, r_b   sums of y y' and of y u over block b; M, r those over all
//   N_b        what noise is expected to add to M_b; N likewise
//   theta      the parameters: of a, v, x, 1, ... mass, friction, stiffness, offset, ...
//   n, p       number of blocks, of parameters
//   t          97.5 % quantile of Student's distribution, n - p degrees of freedom, times 1.15:
//              a user who reads a conclusion every second tests many times
//
// Estimate:  theta = (M - N)^-1 r (W. A. Fuller, Measurement Error Models, 1987, section 1.2 and
//            2.2). The noise of u is only in the residual: it biases nothing, whatever its size or
//            colour. N_u'u' and the covariance of u with u'' have the drive's own noise.
// Known mass: u - m_0 a replaces u
// Even noise kept: N of a, x and X^k stays in M, which regularises any direction of pure noise
//            without harm. v is independent of them, because the kernel's derivatives of odd and
//            even order do not mix: friction is estimated in this way.
// Delay:     u(t + tau) = u + tau u' + tau^2 u''/2: r gains tau^2/2 sum y u'', three iterations.
// Interval:  with I = (M - N)^-1, D = 1 / I_ii, g = D (row i of I), per block
//              alpha_b = g'(r_b - (M_b - N_b) theta),  beta_b = g'(M_b - N_b) g,
//            and with A, B, C the scatter of alpha^2, alpha beta, beta^2 about their means, times
//            n / (n - p): all d with (D^2 - t^2 C) d^2 + 2 t^2 B d - t^2 A <= 0 (E. C. Fieller,
//            J. R. Stat. Soc. B 16 (1954) 175). It is unbounded if D^2 <= t^2 C: the excitation,
//            noise taken out, is then not above its own scatter.
// Trend:     sum (b - b_0) alpha_b, of variance sum (b - b_0)^2 alpha_b^2, b_0 the mean place of
//            beta: about 0 if the parameter does not change along the recording. A delay of the
//            drive adds to it when the rhythm changes.
// Residual:  R = mean e_f^2 over its expectation from the noise of u and y: 1 if both are white
#pragma once

#include <utility>

#include "condyle/estimator/impedance/regression_data.h"
#include "condyle/estimator/provenance.h"

namespace condyle {

/// The most columns that a fit has.
inline constexpr std::size_t kMostFitted = 10;

/// The columns of a fit, and its options.
struct FitColumns {
  std::array<RegressionColumn, kMostFitted> columns{};
  std::size_t count = 0;
  bool keeps_even_noise = false;
  double known_mass_kg = 0;  ///< m_0: not fitted, a has no column

  void add(RegressionColumn column) { columns[count++] = column; }
  /// Index of a column; `count` if it is not one of them.
  std::size_t place_of(RegressionColumn column) const {
    std::size_t place = 0;
    while (place < count && columns[place] != column) ++place;
    return place;
  }
};

/// One parameter of a fit. NaN or infinite if it is not known.
struct FittedValue {
  static constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  double value = std::numeric_limits<double>::quiet_NaN();
  double sd = kUnbounded;        ///< half of the 95 % interval, over 1.96
  double per_delay = 0;          ///< effect of a second of the drive's delay
  double per_delay2 = 0;         ///< the same, per square second, times 2
  double per_known_mass = 0;     ///< effect of a kilogram more of known mass
  double correction = 0;         ///< change from removing the noise
  double trend = 0, trend2 = 0;  ///< see above: the sum, and its variance
  double trend_per_delay = 0;    ///< effect of a second of the drive's delay on the sum
  bool is_known() const { return sd < kUnbounded; }
};

namespace internal {

/// 97.5 % quantile of Student's distribution (Abramowitz and Stegun, 26.7.5).
inline double student_quantile(double degrees) {
  const double z = kNormalQuantile95, v = degrees < 1 ? 1 : degrees;
  const double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4 * v) + (5 * z5 + 16 * z3 + 3 * z) / (96 * v * v) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * v * v * v);
}

using FitMatrix = std::array<std::array<double, kMostFitted>, kMostFitted>;

/// Inverse of the leading `size` rows of a symmetric matrix, by Gauss and Jordan with scaling and
/// pivots. False if it is singular to rounding or a diagonal is not positive.
inline bool invert_leading(FitMatrix A, std::size_t size, FitMatrix& inverse) {
  using std::abs;
  using std::sqrt;
  constexpr double kSingular = 1e-13;
  std::array<double, kMostFitted> scale{};
  for (std::size_t i = 0; i < size; ++i) {
    if (!(A[i][i] > 0)) return false;
    scale[i] = 1 / sqrt(A[i][i]);
  }
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      A[i][j] *= scale[i] * scale[j];
      inverse[i][j] = i == j ? 1 : 0;
    }
  }
  for (std::size_t k = 0; k < size; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < size; ++i) {
      if (abs(A[i][k]) > abs(A[pivot][k])) pivot = i;
    }
    if (!(abs(A[pivot][k]) > kSingular)) return false;
    std::swap(A[k], A[pivot]);
    std::swap(inverse[k], inverse[pivot]);
    const double share = 1 / A[k][k];
    for (std::size_t j = 0; j < size; ++j) {
      A[k][j] *= share;
      inverse[k][j] *= share;
    }
    for (std::size_t i = 0; i < size; ++i) {
      const double factor = A[i][k];
      if (i == k || factor == 0) continue;
      for (std::size_t j = 0; j < size; ++j) {
        A[i][j] -= factor * A[k][j];
        inverse[i][j] -= factor * inverse[k][j];
      }
    }
  }
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) inverse[i][j] *= scale[i] * scale[j];
    if (!(inverse[i][i] > 0)) return false;
  }
  return true;
}

}  // namespace internal

/// One fit. Fixed size, no allocation.
template <class Scalar>
class RegressionFit {
 public:
  /// `data` must live as long as this.
  RegressionFit(const RegressionData<Scalar>& data, const FitColumns& fit)
      : data_(data), fit_(fit), size_(fit.count) {
    for (std::size_t i = 0; i < size_; ++i) {
      for (std::size_t j = 0; j < size_; ++j) {
        N_[i][j] = sign(i) * sign(j) * data.noise(data.sum(), column(i), column(j));
        M_[i][j] = less_noise(data.sum(), i, j);
      }
    }
    is_solved_ = data.size() > size_ && internal::invert_leading(M_, size_, I_);
    if (!is_solved_) return;
    solve();
    const std::size_t delay = fit.place_of(kDriveSlopeColumn);
    for (int k = 0; k < 3 && delay < size_; ++k) {
      tau_ = theta_[delay];
      solve();
    }
    make_residual();
  }

  /// False if the matrix has no inverse, or there are no more blocks than parameters.
  bool is_solved() const { return is_solved_; }
  /// R; see above.
  double residual() const { return residual_; }
  /// R if it is solved and lower than `other`; else `other`.
  double lower_residual(double other) const {
    return is_solved_ && residual_ < other ? residual_ : other;
  }
  /// The value alone.
  double value(RegressionColumn of) const { return theta_[fit_.place_of(of)]; }

  /// A parameter with its full uncertainty; unknown if the fit is not solved.
  FittedValue fitted(RegressionColumn of) const {
    FittedValue fitted;
    const std::size_t i = fit_.place_of(of);
    if (!is_solved_ || i == size_) return fitted;
    fitted.value = theta_[i];
    for (std::size_t j = 0; j < size_; ++j) {
      fitted.per_delay += I_[i][j] * less_noise_with(data_.sum(), j, kDriveSlopeColumn);
      fitted.per_delay2 += I_[i][j] * less_noise_with(data_.sum(), j, kDriveCurvatureColumn);
      fitted.per_known_mass -= I_[i][j] * of_known_mass(data_.sum(), j);
      double Ntheta = fit_.known_mass_kg * noise_with_mass(j);
      for (std::size_t k = 0; k < size_; ++k) Ntheta += N_[j][k] * theta_[k];
      fitted.correction += I_[i][j] * Ntheta;
    }
    make_interval(i, fitted);
    return fitted;
  }

 private:
  RegressionColumn column(std::size_t i) const { return fit_.columns[i]; }
  double sign(std::size_t i) const { return column(i) == kDriveSlopeColumn ? -1 : 1; }
  static bool is_even(RegressionColumn column) {
    return column == kAccelerationColumn || column == kPositionColumn || column == kSquareColumn ||
           column == kCubeColumn || column == kFourthColumn;
  }

  template <class Sum>
  double less_noise(const RegressionSums<Sum>& sums, std::size_t i, std::size_t j) const {
    const bool is_kept = fit_.keeps_even_noise && is_even(column(i)) && is_even(column(j));
    const double product = static_cast<double>(sums.product(column(i), column(j)));
    return sign(i) * sign(j) *
           (is_kept ? product : product - data_.noise(sums, column(i), column(j)));
  }
  template <class Sum>
  double less_noise_with(const RegressionSums<Sum>& sums, std::size_t i, RegressionColumn j) const {
    return sign(i) *
           (static_cast<double>(sums.product(column(i), j)) - data_.noise(sums, column(i), j));
  }
  // Column i times a, corrected for the known mass.
  template <class Sum>
  double of_known_mass(const RegressionSums<Sum>& sums, std::size_t i) const {
    if (fit_.known_mass_kg == 0) return 0;
    if (!fit_.keeps_even_noise) return less_noise_with(sums, i, kAccelerationColumn);
    return sign(i) * static_cast<double>(sums.product(column(i), kAccelerationColumn));
  }
  double noise_with_mass(std::size_t i) const {
    return sign(i) * data_.noise(data_.sum(), column(i), kAccelerationColumn);
  }
  // r, with the drive moved back by tau to second order.
  template <class Sum>
  double right_side(const RegressionSums<Sum>& sums, std::size_t i) const {
    const double r =
        less_noise_with(sums, i, kDriveColumn) - fit_.known_mass_kg * of_known_mass(sums, i);
    return tau_ == 0 ? r : r + tau_ * tau_ / 2 * less_noise_with(sums, i, kDriveCurvatureColumn);
  }

  void solve() {
    std::array<double, kMostFitted> r{};
    for (std::size_t i = 0; i < size_; ++i) r[i] = right_side(data_.sum(), i);
    for (std::size_t i = 0; i < size_; ++i) {
      theta_[i] = 0;
      for (std::size_t j = 0; j < size_; ++j) theta_[i] += I_[i][j] * r[j];
    }
  }

  void make_residual() {
    const RegressionSums<double>& sum = data_.sum();
    // The drive, moved back by tau to second order, is u + bend u''.
    const double bend = tau_ * tau_ / 2;
    const auto of_drive = [bend](const auto& product) {
      return product(kDriveColumn, kDriveColumn) +
             2 * bend * product(kDriveColumn, kDriveCurvatureColumn) +
             bend * bend * product(kDriveCurvatureColumn, kDriveCurvatureColumn);
    };
    double square = of_drive([&sum](auto i, auto j) { return sum.product(i, j); });
    double expected = of_drive([&](auto i, auto j) { return data_.noise(sum, i, j); });
    const double m0 = fit_.known_mass_kg;
    square += m0 * (m0 * sum.product(kAccelerationColumn, kAccelerationColumn) -
                    2 * sum.product(kAccelerationColumn, kDriveColumn) -
                    2 * bend * sum.product(kAccelerationColumn, kDriveCurvatureColumn));
    expected += m0 * m0 * data_.noise(sum, kAccelerationColumn, kAccelerationColumn);
    for (std::size_t i = 0; i < size_; ++i) {
      square += 2 * m0 * theta_[i] * sign(i) * sum.product(column(i), kAccelerationColumn);
      expected += 2 * m0 * theta_[i] * noise_with_mass(i);
      square -= 2 * theta_[i] * sign(i) *
                (sum.product(column(i), kDriveColumn) +
                 bend * sum.product(column(i), kDriveCurvatureColumn));
      for (std::size_t j = 0; j < size_; ++j) {
        const double product = theta_[i] * theta_[j];
        square += product * sign(i) * sign(j) * sum.product(column(i), column(j));
        expected += product * N_[i][j];
      }
    }
    residual_ = square / expected;
  }

  void make_interval(std::size_t i, FittedValue& fitted) const {
    using std::sqrt;
    const double D = 1 / I_[i][i];
    std::array<double, kMostFitted> g{};
    for (std::size_t j = 0; j < size_; ++j) g[j] = D * I_[i][j];
    const std::size_t n = data_.size();
    std::array<double, kMostFitted> delayed{};  // effect of a second of delay on theta
    for (std::size_t j = 0; j < size_; ++j) {
      for (std::size_t k = 0; k < size_; ++k) {
        delayed[j] += I_[j][k] * less_noise_with(data_.sum(), k, kDriveSlopeColumn);
      }
    }
    std::array<double, RegressionBlocks<Scalar>::kBlocks> alphas{}, delay_scores{};
    double A = 0, B = 0, C = 0, alpha_sum = 0, beta_sum = 0, place_sum = 0;
    for (std::size_t b = 0; b < n; ++b) {
      const RegressionSums<Scalar>& sums = data_.block(b);
      double alpha = 0, beta = 0;
      for (std::size_t j = 0; j < size_; ++j) {
        double score = right_side(sums, j), Mg = 0;
        double delay_score = less_noise_with(sums, j, kDriveSlopeColumn);
        for (std::size_t k = 0; k < size_; ++k) {
          const double m = less_noise(sums, j, k);
          score -= m * theta_[k];
          delay_score -= m * delayed[k];
          Mg += m * g[k];
        }
        alpha += g[j] * score;
        delay_scores[b] += g[j] * delay_score;
        beta += g[j] * Mg;
      }
      alphas[b] = alpha;
      A += alpha * alpha;
      B += alpha * beta;
      C += beta * beta;
      alpha_sum += alpha;
      beta_sum += beta;
      place_sum += static_cast<double>(b) * beta;
    }
    const double count = static_cast<double>(n), f = count / (count - static_cast<double>(size_));
    A = f * (A - alpha_sum * alpha_sum / count);
    B = f * (B - alpha_sum * beta_sum / count);
    C = f * (C - beta_sum * beta_sum / count);
    const double t = kLooks * internal::student_quantile(count - static_cast<double>(size_)),
                 t2 = t * t;
    const double quadratic = D * D - t2 * C, linear = t2 * B;
    if (quadratic > 0) {
      const double root = sqrt(linear * linear + quadratic * t2 * A),
                   half_low = (root + linear) / quadratic, half_high = (root - linear) / quadratic;
      fitted.sd = (half_low > half_high ? half_low : half_high) / kNormalQuantile95;
    }
    const double place = place_sum / beta_sum;
    for (std::size_t b = 0; b < n; ++b) {
      const double distance = static_cast<double>(b) - place, term = distance * alphas[b];
      fitted.trend += term;
      fitted.trend2 += term * term;
      fitted.trend_per_delay += distance * delay_scores[b];
    }
  }

  static constexpr double kLooks = 1.15;

  const RegressionData<Scalar>& data_;
  FitColumns fit_;
  std::size_t size_;
  internal::FitMatrix M_{}, N_{}, I_{};
  std::array<double, kMostFitted> theta_{};
  double tau_ = 0, residual_ = 0;
  bool is_solved_ = false;
};

}  // namespace condyle
