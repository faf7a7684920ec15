// SPDX-License-Identifier: Apache-2.0
// What a board provides to an image. No heap; only the UART's interrupt runs beside the caller.
#pragma once

#include <cstddef>
#include <cstdint>

#include "condyle/hal/clock.h"

namespace condyle::cortex_m {

/// Why the image started.
enum class ResetCause : std::uint32_t {
  power_on,  ///< nothing is known from before
  restart,   ///< on request
  fault,     ///< see `last_fault`
  watchdog,  ///< the watchdog was not fed; `last_fault` has the place
  outside,   ///< the reset pin, or the watchdog if its interrupt was blocked
};

/// The core's record of a fault.
struct FaultRecord {
  std::uint32_t exception = 0;  ///< number of the exception: 3 hard fault, 2 the watchdog's NMI
  std::uint32_t pc = 0, lr = 0;
  std::uint32_t cfsr = 0, hfsr = 0;
  std::uint32_t bfar = 0;  ///< valid if bit 15 of cfsr is set
};

/// Number of starts since power-on, this one included.
std::uint32_t start_count();
/// Why the image started last.
ResetCause reset_cause();
/// True if a fault or the watchdog ended the previous run; `record` then has the place.
bool last_fault(FaultRecord& record);
/// Restarts the image, with ResetCause::restart.
[[noreturn]] void restart();

/// UART with 8 bits, no parity; received bytes go to a ring by interrupt.
void uart_init(std::uint32_t bits_per_s);
/// Waits for room.
void uart_write(std::uint8_t byte);
void uart_write(const std::uint8_t* bytes, std::size_t count);
/// The next received byte; false if there is none.
bool uart_read(std::uint8_t& byte);
/// Received bytes lost since `uart_init`, because the ring was full or the UART was overrun (an
/// overrun counts as one byte, however many were lost).
struct UartLosses {
  std::uint32_t ring_full = 0, overruns = 0;
};
UartLosses uart_losses();
/// Sleeps until an interrupt, unless a byte is waiting.
void uart_wait();

/// Starts the clock at 0.
void clock_start();
/// Time since `clock_start`; wraps after 13 years. May be called in interrupts.
TimeNs now_ns();

/// The board's clock for the run loop; it waits without sleeping. Call `clock_start` first.
class BoardClock final : public hal::Clock {
 public:
  TimeNs now_ns() override { return cortex_m::now_ns(); }
  void sleep_until(TimeNs time_ns) override {
    while (cortex_m::now_ns() < time_ns) {
    }
  }
};

/// From now on the image restarts unless it feeds the watchdog every `period_ms`.
void watchdog_start(std::uint32_t period_ms);
void watchdog_feed();

/// Deepest use of the stack since the start, interrupts included.
std::size_t stack_used_bytes();
/// Size of the stack.
std::size_t stack_size_bytes();

}  // namespace condyle::cortex_m
