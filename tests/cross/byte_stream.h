// SPDX-License-Identifier: Apache-2.0
// Numbers as bytes, little endian, and NaN always the same NaN: machines differ in its sign.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace condyle::cross {

/// Gives the bytes of `value` to `sink(byte)`, the lowest first.
template <std::unsigned_integral Number, class Sink>
void put_number(Number value, Sink&& sink) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    sink(static_cast<std::uint8_t>(std::uint64_t{value} >> (8 * i)));
  }
}

/// The same of a floating-point number's bits.
template <std::floating_point Number, class Sink>
void put_number(Number value, Sink&& sink) {
  using Bits = std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>;
  if (value != value) value = std::numeric_limits<Number>::quiet_NaN();
  put_number(std::bit_cast<Bits>(value), sink);
}

/// Takes a number from `source()`, which gives a byte at each call.
template <class Number, class Source>
Number take_number(Source&& source) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bits |= std::uint64_t{static_cast<std::uint8_t>(source())} << (8 * i);
  }
  if constexpr (std::is_integral_v<Number>) {
    return static_cast<Number>(bits);
  } else if constexpr (sizeof(Number) == 4) {
    return std::bit_cast<Number>(static_cast<std::uint32_t>(bits));
  } else {
    return std::bit_cast<Number>(bits);
  }
}

}  // namespace condyle::cross
