// SPDX-License-Identifier: Apache-2.0
// Dual numbers: a value with its slope along one direction (forward automatic differentiation).
// Nested, Dual<Dual<...>>, they give derivatives of any order. (Eigen's AutoDiffScalar does not
// nest.)
#pragma once

#include <type_traits>

namespace condyle {

/// Value and directional derivative. T is a scalar or another Dual.
template <class T>
struct Dual {
  T value{};
  T slope{};

  constexpr Dual() = default;
  /// A constant: its slope is zero.
  template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
  constexpr Dual(Number constant) : value(static_cast<T>(constant)) {}
  /// `value` moving at `slope`.
  constexpr Dual(const T& value_in, const T& slope_in) : value(value_in), slope(slope_in) {}

  friend constexpr Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.slope + b.slope};
  }
  friend constexpr Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.slope - b.slope};
  }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    const T quotient = a.value / b.value;
    return {quotient, (a.slope - quotient * b.slope) / b.value};
  }
};

}  // namespace condyle
