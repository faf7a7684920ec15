// SPDX-License-Identifier: Apache-2.0
// The arithmetic that every estimator file uses, and the compiler settings it depends on.
#pragma once

#include <Eigen/Core>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <limits>

#ifdef __FAST_MATH__
#error "condyle: build without -ffast-math; it removes the checks for NaN and infinity"
#endif
#ifndef EIGEN_DONT_VECTORIZE
#error "condyle: link condyle::estimator (or define EIGEN_DONT_VECTORIZE and -ffp-contract=off)"
#endif
static_assert(FLT_EVAL_METHOD == 0, "condyle: no extended intermediate precision (no x87)");
static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<float>::is_iec559);

namespace condyle {

/// Column of three scalars.
template <class Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;

/// 3 x 3.
template <class Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

/// Array of `n`; an int, as its indices are.
template <class T, int n>
using Array = T[static_cast<std::size_t>(n)];

}  // namespace condyle
