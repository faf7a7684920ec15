// SPDX-License-Identifier: Apache-2.0
// Least squares of a polynomial of up to four terms over samples at the places x: value and slope
// at x = 0.
//
//   N   normal matrix, N(i, j) = sum of x^(i + j)
//   m   moments of the samples, m(i) = sum of x^i y
//   value = row 0 of N^-1 times m, slope = row 1 times m
#pragma once

#include <Eigen/Core>
#include <array>

namespace condyle::host {

/// Sums of the powers 0 to 6 of places.
class PowerSums {
 public:
  void add(double x) {
    const double square = x * x, cube = square * x;
    sums_[0] += 1;
    sums_[1] += x;
    sums_[2] += square;
    sums_[3] += cube;
    sums_[4] += square * square;
    sums_[5] += square * cube;
    sums_[6] += cube * cube;
  }

  /// The rows of value and slope; of a polynomial of `terms` terms the others are 0.
  std::array<Eigen::RowVector4d, 2> rows(int terms = 4) const {
    const auto n = [&](int i, int j) {
      return i < terms && j < terms ? sums_[static_cast<std::size_t>(i + j)] : i == j ? 1.0 : 0.0;
    };
    // By cofactors, from the minors of the rows 2 and 3; N is symmetric.
    const auto minor = [&](int i, int j) { return n(2, i) * n(3, j) - n(2, j) * n(3, i); };
    const double m01 = minor(0, 1), m02 = minor(0, 2), m03 = minor(0, 3);
    const double m12 = minor(1, 2), m13 = minor(1, 3), m23 = minor(2, 3);
    const auto cofactors = [&](int row) {
      return Eigen::RowVector4d(n(row, 1) * m23 - n(row, 2) * m13 + n(row, 3) * m12,
                                n(row, 2) * m03 - n(row, 0) * m23 - n(row, 3) * m02,
                                n(row, 0) * m13 - n(row, 1) * m03 + n(row, 3) * m01,
                                n(row, 1) * m02 - n(row, 0) * m12 - n(row, 2) * m01);
    };
    const Eigen::RowVector4d value = cofactors(1);
    const Eigen::RowVector4d slope =
        terms > 1 ? Eigen::RowVector4d(-cofactors(0)) : Eigen::RowVector4d::Zero();
    const double determinant =
        n(0, 0) * value[0] + n(0, 1) * value[1] + n(0, 2) * value[2] + n(0, 3) * value[3];
    return {value / determinant, slope / determinant};
  }

 private:
  std::array<double, 7> sums_{};
};

}  // namespace condyle::host
