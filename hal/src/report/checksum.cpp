// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/checksum.h"

namespace condyle::hal {
namespace {

constexpr std::uint32_t reflected(std::uint32_t value, unsigned width_bits) {
  std::uint32_t result = 0;
  for (unsigned bit = 0; bit < width_bits; ++bit)
    result |= (value >> bit & 1U) << (width_bits - 1 - bit);
  return result;
}

}  // namespace

std::uint32_t checksum_of(const Checksum& model, std::span<const std::uint8_t> bytes) {
  const std::uint32_t top = std::uint32_t{1} << (model.width_bits - 1);
  std::uint32_t sum = model.initial;
  for (const std::uint8_t byte : bytes) {
    const std::uint32_t next = model.reflects_input ? reflected(byte, 8) : byte;
    sum ^= next << (model.width_bits - 8);
    for (int bit = 0; bit < 8; ++bit)
      sum = (sum & top) != 0 ? sum << 1U ^ model.polynomial : sum << 1U;
    sum &= 2 * top - 1;
  }
  if (model.reflects_output) sum = reflected(sum, model.width_bits);
  return sum ^ model.final_xor;
}

}  // namespace condyle::hal
