// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "registers.h"

namespace condyle::cortex_m {

/// Watchdog of Arm's CMSDK, at `kAddress`, counting `kClock_Hz`.
template <std::uint32_t kAddress, std::uint32_t kClock_Hz>
struct CmsdkWatchdog {
  static void start(std::uint32_t period_ms) {
    reg(kAddress + kLock) = 0x1ACCE551;
    reg(kAddress + kLoad) = kClock_Hz / 1000 * period_ms;
    reg(kAddress + kControl) = 3;  // first an interrupt; if that is not served, a reset
  }
  static void feed() { reg(kAddress + kFeed) = 1; }

 private:
  static constexpr std::uint32_t kLoad = 0x00, kControl = 0x08, kFeed = 0x0C, kLock = 0xC00;
};

}  // namespace condyle::cortex_m
