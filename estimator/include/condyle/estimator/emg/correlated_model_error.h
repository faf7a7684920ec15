// SPDX-License-Identifier: Apache-2.0
// Effect of an error that follows the motion on values that are fitted to the motion.
//
//   y         what the n values multiply
//   e         error of the fitted sum, of size E = rms e, that follows the motion: no number of
//             samples averages it out
//   M         mean(y y')
//   P         variances of the values' priors, diagonal
//
// e bends the values by M^-1 mean(y e). Of all e of size E the worst does E sqrt((M^-1)_ii) to
// value i; for a single y, E / rms(y). With the priors:
//   G = (M / E^2 + P^-1)^-1 = D (I + D M D / E^2)^-1 D,  D = sqrt(P)
// as if all samples together held no more information on the values than one.
#pragma once

#include <Eigen/Cholesky>

#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/math/symmetric_matrix.h"

namespace condyle {

/// M of `n` values, and the diagonal of G. Fixed size, no allocation.
template <class Scalar, int n>
class CorrelatedModelError {
 public:
  using Vector = Eigen::Matrix<Scalar, n, 1>;

  /// Adds `y` to the means with this weight: its share of all time so far.
  void add(const Vector& y, Scalar weight) {
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j) mean_(i, j) += weight * (y[i] * y[j] - mean_(i, j));
    }
  }

  /// Diagonal of G for an error of mean square `E2` > 0 and the priors' standard deviations `D`.
  Vector variances(Scalar E2, const Vector& D) const {
    using Matrix = Eigen::Matrix<Scalar, n, n>;
    Matrix scaled;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) scaled(i, j) = D[i] * mean_(i, j) * D[j] / E2;
      scaled(i, i) += Scalar(1);
    }
    const Eigen::LLT<Matrix> factor(scaled);
    const Matrix inverse = factor.solve(Matrix::Identity());
    Vector variances;
    for (int i = 0; i < n; ++i) {
      const Scalar share = inverse(i, i);
      const bool is_usable = share >= Scalar(0) && share < Scalar(1);  // else unknown
      variances[i] = D[i] * D[i] * (is_usable ? share : Scalar(1));
    }
    return variances;
  }

 private:
  SymmetricMatrix<Scalar, n> mean_;
};

}  // namespace condyle
