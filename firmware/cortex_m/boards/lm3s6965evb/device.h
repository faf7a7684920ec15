// SPDX-License-Identifier: Apache-2.0
// Stellaris LM3S6965 board as QEMU models it (no clock gates, no pin functions): PL011 UART with
// FIFO, watchdog of the CMSDK kind.
#pragma once

#include "cmsdk_watchdog.h"

namespace condyle::cortex_m {

inline constexpr std::uint32_t kClock_Hz = 12'500'000;  // as after reset: 200 MHz / 16
using Watchdog = CmsdkWatchdog<0x40000000, kClock_Hz>;
inline constexpr int kUartInterrupt = 5, kWatchdogInterrupt = 18;

/// UART 0.
struct Uart {
  static void start(std::uint32_t bits_per_s) {
    const std::uint32_t divider_64ths = kClock_Hz * 4 / bits_per_s;
    reg(kControl) = 0;
    reg(kDividerWhole) = divider_64ths / 64;
    reg(kDivider64ths) = divider_64ths % 64;
    reg(kLine) = 3U << 5U | 1U << 4U;           // 8 bits, FIFO
    reg(kInterruptMask) = 1U << 4U | 1U << 6U;  // receive: level or timeout
    reg(kControl) = 1U << 0U | 1U << 8U | 1U << 9U;
  }
  static bool has_room() { return (reg(kFlags) & 1U << 5U) == 0; }
  static bool has_byte() { return (reg(kFlags) & 1U << 4U) == 0; }
  static bool take_overrun() {
    const bool overrun = (reg(kErrors) & 8U) != 0;
    if (overrun) reg(kErrors) = 0;
    return overrun;
  }
  static void put(std::uint8_t byte) { reg(kData) = byte; }
  static std::uint8_t take() {
    const auto byte = static_cast<std::uint8_t>(reg(kData));
    reg(kInterruptClear) = 1U << 4U | 1U << 6U;
    return byte;
  }

 private:
  static constexpr std::uint32_t kData = 0x4000C000, kErrors = 0x4000C004, kFlags = 0x4000C018,
                                 kDividerWhole = 0x4000C024, kDivider64ths = 0x4000C028,
                                 kLine = 0x4000C02C, kControl = 0x4000C030,
                                 kInterruptMask = 0x4000C038, kInterruptClear = 0x4000C044;
};

}  // namespace condyle::cortex_m
