// SPDX-License-Identifier: Apache-2.0
// Arm MPS2 board with image AN386 (Cortex-M4) or AN500 (Cortex-M7): CMSDK peripherals.
// In QEMU, a byte that arrives before the last is taken is lost unless -icount slows the machine.
#pragma once

#include "cmsdk_uart.h"
#include "cmsdk_watchdog.h"

namespace condyle::cortex_m {

inline constexpr std::uint32_t kClock_Hz = 25'000'000;
using Watchdog = CmsdkWatchdog<0x40008000, kClock_Hz>;  // its interrupt is the NMI
inline constexpr int kUartInterrupt = 0, kWatchdogInterrupt = kIsNmi;
using Uart = CmsdkUart<0x40004000, kClock_Hz>;  // UART 0

}  // namespace condyle::cortex_m
