// SPDX-License-Identifier: Apache-2.0
// STMicroelectronics STM32F405 (Cortex-M4F, 1 MB flash, 128 kB RAM) with its settings after reset:
// 16 MHz from its internal oscillator. UART: USART1, transmit on PA9, receive on PA10. Register
// names and addresses: ST, reference manual RM0090.
#pragma once

#include "registers.h"

namespace condyle::cortex_m {

inline constexpr std::uint32_t kClock_Hz = 16'000'000;
inline constexpr int kUartInterrupt = 37, kWatchdogInterrupt = kHasNone;

/// IWDG, on its own oscillator of about 32 kHz. It resets at once, so a hang leaves no record.
struct Watchdog {
  static void start(std::uint32_t period_ms) {
    reg(kKey) = 0xCCCC;   // on; cannot be switched off
    reg(kKey) = 0x5555;   // unlocks the next two writes
    reg(kPrescaler) = 3;  // of 32
    reg(kReload) = period_ms < 4096 ? period_ms : 4095;
    reg(kKey) = kFeed;
  }
  static void feed() { reg(kKey) = kFeed; }

 private:
  static constexpr std::uint32_t kKey = 0x40003000, kPrescaler = 0x40003004, kReload = 0x40003008,
                                 kFeed = 0xAAAA;
};

/// USART1.
struct Uart {
  static void start(std::uint32_t bits_per_s) {
    reg(kAhb1Enable) = reg(kAhb1Enable) | 1U << 0U;                      // port A
    reg(kApb2Enable) = reg(kApb2Enable) | 1U << 4U;                      // USART1
    reg(kPortAMode) = (reg(kPortAMode) & ~(0xFU << 18U)) | 0xAU << 18U;  // alternate functions
    reg(kPortAAlternateHigh) = (reg(kPortAAlternateHigh) & ~0xFF0U) | 0x770U;  // number 7
    reg(kBitRate) = (kClock_Hz + bits_per_s / 2) / bits_per_s;
    reg(kControl) = 1U << 13U | 1U << 5U | 1U << 3U | 1U << 2U;  // on, interrupt, both ways
  }
  static bool has_room() { return (reg(kState) & 1U << 7U) != 0; }
  static bool has_byte() { return (reg(kState) & 1U << 5U) != 0; }
  /// Reading the data clears it; a byte waiting there is read afterwards anyway.
  static bool take_overrun() {
    const bool overrun = (reg(kState) & 1U << 3U) != 0;
    if (overrun && !has_byte()) (void)take();
    return overrun;
  }
  static void put(std::uint8_t byte) { reg(kData) = byte; }
  static std::uint8_t take() { return static_cast<std::uint8_t>(reg(kData)); }

 private:
  static constexpr std::uint32_t kAhb1Enable = 0x40023830, kApb2Enable = 0x40023844,
                                 kPortAMode = 0x40020000, kPortAAlternateHigh = 0x40020024,
                                 kState = 0x40011000, kData = 0x40011004, kBitRate = 0x40011008,
                                 kControl = 0x4001100C;
};

}  // namespace condyle::cortex_m
