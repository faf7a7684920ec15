// SPDX-License-Identifier: Apache-2.0
// Writes fields into reports bit by bit: slow, and another way than the decoder's.
#pragma once

#include <cstdint>
#include <vector>

#include "condyle/hal/hid/device_profile.h"

namespace condyle::testing_support {

/// Sets the bits of `field` to the low ones of `raw`.
inline void write_bits(std::vector<std::uint8_t>& bytes, const hal::ReportField& field,
                       std::uint64_t raw) {
  const std::uint32_t width = field.width_bits;
  for (std::uint32_t bit = 0; bit < width; ++bit) {
    // The most significant byte comes first where the order is big.
    const std::uint32_t place =
        field.byte_order == hal::ByteOrder::little ? bit : width - 8 - bit / 8 * 8 + bit % 8;
    const std::uint32_t at = field.offset_bits + place;
    const auto mask = static_cast<std::uint8_t>(1U << at % 8);
    std::uint8_t& byte = bytes.at(at / 8);
    byte = static_cast<std::uint8_t>((raw >> bit & 1U) != 0 ? byte | mask : byte & ~mask);
  }
}

}  // namespace condyle::testing_support
