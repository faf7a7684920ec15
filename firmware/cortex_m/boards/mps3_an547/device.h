// SPDX-License-Identifier: Apache-2.0
// Arm MPS3 board with image AN547 (Cortex-M55); everything runs on its secure side.
#pragma once

#include "cmsdk_uart.h"
#include "cmsdk_watchdog.h"

namespace condyle::cortex_m {

inline constexpr std::uint32_t kClock_Hz = 32'000'000;
using Watchdog = CmsdkWatchdog<0x5802E000, 32'768>;  // its interrupt is the NMI
inline constexpr int kUartInterrupt = 33, kWatchdogInterrupt = kIsNmi;
using Uart = CmsdkUart<0x59303000, kClock_Hz>;  // UART 0

}  // namespace condyle::cortex_m
