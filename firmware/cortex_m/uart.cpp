// SPDX-License-Identifier: Apache-2.0
#include "condyle/cortex_m/board.h"
#include "condyle/firmware/ring.h"
#include "device.h"
#include "faults.h"

namespace condyle::cortex_m {
namespace {

constinit firmware::Ring<std::uint8_t, 2048> g_received;
constinit volatile std::uint32_t g_overruns = 0;

}  // namespace

void uart_init(std::uint32_t bits_per_s) {
  Uart::start(bits_per_s);
  enable_interrupt(kUartInterrupt);
}

void uart_write(std::uint8_t byte) {
  while (!Uart::has_room()) {
  }
  Uart::put(byte);
}

void uart_write(const std::uint8_t* bytes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) uart_write(bytes[i]);
}

bool uart_read(std::uint8_t& byte) {
  return g_received.pop(byte);
}

UartLosses uart_losses() {
  return {static_cast<std::uint32_t>(g_received.dropped()), g_overruns};
}

// A masked interrupt still ends the sleep, so none is missed between the check and the sleep.
void uart_wait() {
  asm volatile("cpsid i" ::: "memory");
  if (g_received.empty()) asm volatile("dsb\n wfi" ::: "memory");
  asm volatile("cpsie i\n isb" ::: "memory");
}

}  // namespace condyle::cortex_m

extern "C" void uart_handler() {
  using namespace condyle::cortex_m;
  if (Uart::take_overrun()) g_overruns = g_overruns + 1;
  while (Uart::has_byte()) g_received.push(Uart::take());
}
