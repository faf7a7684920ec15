// SPDX-License-Identifier: Apache-2.0
// A number with the size of its terms, which bounds the rounding error: after a cancellation the
// value is small but the size is not.
#pragma once

#include <type_traits>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// Value, and sum of the absolute values of its terms.
template <class Scalar>
struct Tracked {
  Scalar value{};
  Scalar size{};

  constexpr Tracked() = default;
  /// A number without error, except in its last digit.
  template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
  constexpr Tracked(Number number)
      : value(static_cast<Scalar>(number)), size(value < 0 ? -value : value) {}
  constexpr Tracked(Scalar number, Scalar terms) : value(number), size(terms) {}

  friend constexpr Tracked operator+(const Tracked& a, const Tracked& b) {
    return {a.value + b.value, a.size + b.size};
  }
  friend constexpr Tracked operator-(const Tracked& a, const Tracked& b) {
    return {a.value - b.value, a.size + b.size};
  }
  friend constexpr Tracked operator*(const Tracked& a, const Tracked& b) {
    return {a.value * b.value, a.size * b.size};
  }
  friend constexpr Tracked operator/(const Tracked& a, const Tracked& b) {
    const Scalar divisor = b.value < 0 ? -b.value : b.value;
    return {a.value / b.value, a.size * b.size / (divisor * divisor)};
  }
};

}  // namespace condyle
