// SPDX-License-Identifier: Apache-2.0
// Eigen's solvers that take seconds to compile. The programs of this project link them compiled.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// Largest eigenvalue of a symmetric matrix, n x n, in the matrix's unit. Reads the lower triangle.
template <class Scalar, int n>
Scalar largest_eigenvalue(const Eigen::Matrix<Scalar, n, n>& symmetric) {
  using Solver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<Scalar, n, n>>;
  return Solver(symmetric, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

/// The rotation R, det R = +1, and translation t that minimise sum |R a_i + t - b_i|^2, as the
/// matrix (R t; 0 1), 4 x 4. a_i, b_i: the columns of `from` and `to`, finite, of one unit, which
/// is that of t. Source: Umeyama 1991 (doi 10.1109/34.88573), here Eigen::umeyama.
template <class Scalar>
Eigen::Matrix<Scalar, 4, 4> closest_rigid_motion(const Eigen::Matrix<Scalar, 3, 3>& from,
                                                 const Eigen::Matrix<Scalar, 3, 3>& to) {
  return Eigen::umeyama(from, to, false);
}

namespace internal {
template <class Scalar>
Eigen::Matrix<Scalar, 6, 1> singular_values_of_6_by_6(const Eigen::Matrix<Scalar, 6, 6>& matrix) {
  return Eigen::JacobiSVD<Eigen::Matrix<Scalar, 6, 6>>(matrix).singularValues();
}
}  // namespace internal

/// Singular values of `matrix`, finite, in its unit, the largest first. columns <= rows <= 6.
template <class Scalar, int rows, int columns>
Eigen::Matrix<Scalar, columns, 1> singular_values(
    const Eigen::Matrix<Scalar, rows, columns>& matrix) {
  static_assert(columns <= rows && rows <= 6);
  // Rows and columns of zeros add singular values of 0 only: one size serves all.
  Eigen::Matrix<Scalar, 6, 6> square = Eigen::Matrix<Scalar, 6, 6>::Zero();
  square.template topLeftCorner<rows, columns>() = matrix;
  return internal::singular_values_of_6_by_6(square).template head<columns>();
}

#ifdef CONDYLE_SENSORS_COMPILED  // once, in a library
extern template double largest_eigenvalue(const Eigen::Matrix<double, 6, 6>&);
extern template Eigen::Matrix4d closest_rigid_motion(const Eigen::Matrix3d&,
                                                     const Eigen::Matrix3d&);
extern template Eigen::Matrix<double, 6, 1> internal::singular_values_of_6_by_6(
    const Eigen::Matrix<double, 6, 6>&);
#endif

}  // namespace condyle
