// SPDX-License-Identifier: Apache-2.0
// Between startup and the rest of the board.
#pragma once

namespace condyle::cortex_m {

/// Reads the record that the previous run left; call it once, at startup.
void begin_run();

}  // namespace condyle::cortex_m

extern "C" {
/// Handles every exception without its own handler: keeps a record and restarts.
void fault_handler();
void systick_handler();
void uart_handler();
[[noreturn]] void reset_handler();
}
