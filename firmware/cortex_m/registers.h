// SPDX-License-Identifier: Apache-2.0
// Registers of the core, and access to registers.
#pragma once

#include <cstdint>

namespace condyle::cortex_m {

/// The register at `address`.
inline volatile std::uint32_t& reg(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

// Names of the Armv7-M architecture reference manual.
inline constexpr std::uint32_t kSystCsr = 0xE000E010, kSystRvr = 0xE000E014, kSystCvr = 0xE000E018,
                               kNvicIser = 0xE000E100, kIcsr = 0xE000ED04, kAircr = 0xE000ED0C,
                               kCfsr = 0xE000ED28, kHfsr = 0xE000ED2C, kBfar = 0xE000ED38;

/// Special values instead of an interrupt's number: non-maskable; none.
inline constexpr int kIsNmi = -14, kHasNone = -15;

/// Enables interrupt `number`.
inline void enable_interrupt(int number) {
  if (number < 0) return;
  const auto bit = static_cast<std::uint32_t>(number);
  reg(kNvicIser + bit / 32 * 4) = 1U << bit % 32;
}

}  // namespace condyle::cortex_m
