// SPDX-License-Identifier: Apache-2.0
// Arm MPS2 board with image AN386 (Cortex-M4) or AN500 (Cortex-M7): CMSDK peripherals.
// In QEMU, a byte that comes while the last is not taken is lost unless -icount slows the machine.
#pragma once

#include "cmsdk_watchdog.h"

namespace condyle::cortex_m {

inline constexpr std::uint32_t kClock_Hz = 25'000'000;
using Watchdog = CmsdkWatchdog<0x40008000, kClock_Hz>;  // its interrupt is the NMI
inline constexpr int kUartInterrupt = 0, kWatchdogInterrupt = kIsNmi;

/// UART 0.
struct Uart {
  static void start(std::uint32_t bits_per_s) {
    reg(kBitDivider) = kClock_Hz / bits_per_s;
    reg(kControl) = 1U << 0U | 1U << 1U | 1U << 3U;  // transmit, receive, interrupt on receive
  }
  static bool has_room() { return (reg(kState) & 1U) == 0; }
  static bool has_byte() { return (reg(kState) & 2U) != 0; }
  static bool take_overrun() {
    const bool overrun = (reg(kState) & 8U) != 0;
    if (overrun) reg(kState) = 8;
    return overrun;
  }
  static void put(std::uint8_t byte) { reg(kData) = byte; }
  static std::uint8_t take() {
    const auto byte = static_cast<std::uint8_t>(reg(kData));
    reg(kInterruptClear) = 2;
    return byte;
  }

 private:
  static constexpr std::uint32_t kData = 0x40004000, kState = 0x40004004, kControl = 0x40004008,
                                 kInterruptClear = 0x4000400C, kBitDivider = 0x40004010;
};

}  // namespace condyle::cortex_m
