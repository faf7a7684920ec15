// SPDX-License-Identifier: Apache-2.0
// Arm MPS2 board with image AN505 (Cortex-M33); everything runs on its secure side.
#pragma once

#include "cmsdk_uart.h"
#include "cmsdk_watchdog.h"

namespace condyle::cortex_m {

inline constexpr std::uint32_t kClock_Hz = 20'000'000;
using Watchdog = CmsdkWatchdog<0x5002E000, 32'768>;  // its interrupt is the NMI
inline constexpr int kUartInterrupt = 32, kWatchdogInterrupt = kIsNmi;
using Uart = CmsdkUart<0x50200000, kClock_Hz>;  // UART 0

}  // namespace condyle::cortex_m
