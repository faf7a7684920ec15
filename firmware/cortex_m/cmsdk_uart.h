// SPDX-License-Identifier: Apache-2.0
// The UART of Arm's Cortex-M System Design Kit, as MPS boards have it.
#pragma once

#include "registers.h"

namespace condyle::cortex_m {

/// The UART at `kBase`, clocked with `kInput_Hz`.
template <std::uint32_t kBase, std::uint32_t kInput_Hz>
struct CmsdkUart {
  static void start(std::uint32_t bits_per_s) {
    reg(kBitDivider) = kInput_Hz / bits_per_s;
    reg(kControl) = 1U << 0U | 1U << 1U | 1U << 3U;  // transmit, receive, interrupt on receive
  }
  static bool has_room() { return (reg(kState) & 1U) == 0; }
  static bool has_byte() { return (reg(kState) & 2U) != 0; }
  static bool take_overrun() {
    const bool overrun = (reg(kState) & 8U) != 0;
    if (overrun) reg(kState) = 8;
    return overrun;
  }
  static void put(std::uint8_t byte) { reg(kBase) = byte; }
  static std::uint8_t take() {
    const auto byte = static_cast<std::uint8_t>(reg(kBase));
    reg(kInterruptClear) = 2;
    return byte;
  }

 private:
  static constexpr std::uint32_t kState = kBase + 0x4, kControl = kBase + 0x8,
                                 kInterruptClear = kBase + 0xC, kBitDivider = kBase + 0x10;
};

}  // namespace condyle::cortex_m
