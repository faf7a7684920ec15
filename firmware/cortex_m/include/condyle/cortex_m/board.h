// SPDX-License-Identifier: Apache-2.0
// What an image may ask of its board. No heap; only the UART's interrupt runs beside the caller.
#pragma once

#include <cstddef>
#include <cstdint>

#include "condyle/hal/clock.h"

namespace condyle::cortex_m {

/// Why the image runs.
enum class ResetCause : std::uint32_t {
  power_on,  ///< nothing is known from before
  restart,   ///< asked for
  fault,     ///< see `last_fault`
  watchdog,  ///< the watchdog was not fed; see `last_fault` for where the image was
  outside,   ///< the reset pin, or the watchdog where even its interrupt did not come through
};

/// What the core said of a fault.
struct FaultRecord {
  std::uint32_t exception = 0;  ///< number of the exception: 3 hard fault, 2 the watchdog's NMI
  std::uint32_t pc = 0, lr = 0;
  std::uint32_t cfsr = 0, hfsr = 0;
  std::uint32_t bfar = 0;  ///< says something where bit 15 of cfsr is set
};

/// How often the image was started since power-on, this time included.
std::uint32_t start_count();
/// Why the image was started last.
ResetCause reset_cause();
/// True where a fault or the watchdog ended the run before; `record` then says where.
bool last_fault(FaultRecord& record);
/// Starts the image anew, with ResetCause::restart.
[[noreturn]] void restart();

/// UART with 8 bits, no parity; received bytes go to a ring by interrupt.
void uart_init(std::uint32_t bits_per_s);
/// Waits for room.
void uart_write(std::uint8_t byte);
void uart_write(const std::uint8_t* bytes, std::size_t count);
/// The next received byte; false where there is none.
bool uart_read(std::uint8_t& byte);
/// Received bytes that were lost since `uart_init`: the ring was full; the UART was overrun (one is
/// counted, however many were lost).
struct UartLosses {
  std::uint32_t ring_full = 0, overruns = 0;
};
UartLosses uart_losses();
/// Sleeps until an interrupt, unless a byte waits.
void uart_wait();

/// Starts the clock at 0.
void clock_start();
/// Since `clock_start`; wraps after 13 years. May be asked in interrupts.
TimeNs now_ns();

/// The board's clock as the run loop wants it; it waits awake. `clock_start` comes first.
class BoardClock final : public hal::Clock {
 public:
  TimeNs now_ns() override { return cortex_m::now_ns(); }
  void sleep_until(TimeNs time_ns) override {
    while (cortex_m::now_ns() < time_ns) {
    }
  }
};

/// From now on the image is restarted unless it feeds the watchdog every `period_ms`.
void watchdog_start(std::uint32_t period_ms);
void watchdog_feed();

/// The deepest the stack has been since the start, interrupts included.
std::size_t stack_used_bytes();
/// All of it.
std::size_t stack_size_bytes();

}  // namespace condyle::cortex_m
