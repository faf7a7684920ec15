// SPDX-License-Identifier: Apache-2.0
// Symmetric 3x3 matrix stored as its upper triangle, so that rounding cannot make it unsymmetric.
#pragma once

#include <array>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// Symmetric 3x3 matrix: six scalars, row by row (00, 01, 02, 11, 12, 22).
template <class Scalar>
class SymmetricMatrix3 {
 public:
  /// Zero matrix.
  constexpr SymmetricMatrix3() = default;

  /// Diagonal matrix of the given three entries.
  static SymmetricMatrix3 diagonal(const Vector3<Scalar>& entries) {
    SymmetricMatrix3 matrix;
    for (int i = 0; i < 3; ++i) matrix(i, i) = entries[i];
    return matrix;
  }

  /// Entry (row, column), each 0 to 2; (i, j) and (j, i) are the same scalar.
  constexpr Scalar& operator()(int row, int column) { return packed_[offset(row, column)]; }
  /// Entry (row, column), read only.
  constexpr const Scalar& operator()(int row, int column) const {
    return packed_[offset(row, column)];
  }

  /// Adds `factor` times `other`.
  constexpr void add_scaled(const SymmetricMatrix3& other, Scalar factor) {
    for (std::size_t i = 0; i < packed_.size(); ++i) packed_[i] += factor * other.packed_[i];
  }

  /// The same matrix with all nine entries.
  Eigen::Matrix<Scalar, 3, 3> dense() const {
    Eigen::Matrix<Scalar, 3, 3> matrix;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) matrix(i, j) = (*this)(i, j);
    }
    return matrix;
  }

 private:
  static constexpr std::size_t offset(int row, int column) {
    const int low = row < column ? row : column;
    const int high = row < column ? column : row;
    return static_cast<std::size_t>(low * (5 - low) / 2 + high);
  }

  std::array<Scalar, 6> packed_{};
};

/// Symmetric matrix of any fixed size, stored likewise as its upper triangle, row by row.
template <class Scalar, int size>
class SymmetricMatrix {
 public:
  /// Entry (row, column), each 0 to size - 1; (i, j) and (j, i) are the same scalar.
  constexpr Scalar& operator()(int row, int column) { return packed_[offset(row, column)]; }
  /// Entry (row, column), read only.
  constexpr const Scalar& operator()(int row, int column) const {
    return packed_[offset(row, column)];
  }
  /// Sets row and column `index` to zero.
  constexpr void clear_entry(int index) {
    for (int i = 0; i < size; ++i) (*this)(index, i) = Scalar(0);
  }
  /// Gives row and column `to` the values of `from`, as if a state replaced another, and clears
  /// `from`.
  constexpr void move_entry(int from, int to) {
    (*this)(to, to) = (*this)(from, from);
    for (int i = 0; i < size; ++i) {
      if (i != to && i != from) (*this)(to, i) = (*this)(from, i);
    }
    clear_entry(from);
  }
  /// Takes off S K K', as the update by one measurement of innovation variance `S` does.
  constexpr void take_off(Scalar S, const Eigen::Matrix<Scalar, size, 1>& K) {
    for (int i = 0; i < size; ++i) {
      for (int j = i; j < size; ++j) (*this)(i, j) -= S * K[i] * K[j];
    }
  }
  /// The same matrix with all entries.
  Eigen::Matrix<Scalar, size, size> dense() const {
    Eigen::Matrix<Scalar, size, size> matrix;
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) matrix(i, j) = (*this)(i, j);
    }
    return matrix;
  }

 private:
  static constexpr std::size_t offset(int row, int column) {
    const int low = row < column ? row : column;
    const int high = row < column ? column : row;
    return static_cast<std::size_t>(low * (2 * size - 1 - low) / 2 + high);
  }

  std::array<Scalar, static_cast<std::size_t>(size*(size + 1) / 2)> packed_{};
};

}  // namespace condyle
