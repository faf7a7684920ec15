// SPDX-License-Identifier: Apache-2.0
// A number with the size of its terms, which bounds the rounding error: after a cancellation the
// value is small but the size is not.
#pragma once

#include <type_traits>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// Value, and sum of the absolute values of its terms.
template <class Scalar>
struct RunningError {
  Scalar value{};
  Scalar size{};

  constexpr RunningError() = default;
  /// A number without error, except in its last digit.
  template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
  constexpr RunningError(Number number)
      : value(static_cast<Scalar>(number)), size(value < 0 ? -value : value) {}
  constexpr RunningError(Scalar number, Scalar terms) : value(number), size(terms) {}

  friend constexpr RunningError operator+(const RunningError& a, const RunningError& b) {
    return {a.value + b.value, a.size + b.size};
  }
  friend constexpr RunningError operator-(const RunningError& a, const RunningError& b) {
    return {a.value - b.value, a.size + b.size};
  }
  friend constexpr RunningError operator*(const RunningError& a, const RunningError& b) {
    return {a.value * b.value, a.size * b.size};
  }
  friend constexpr RunningError operator/(const RunningError& a, const RunningError& b) {
    const Scalar divisor = b.value < 0 ? -b.value : b.value;
    return {a.value / b.value, a.size * b.size / (divisor * divisor)};
  }
};

}  // namespace condyle
