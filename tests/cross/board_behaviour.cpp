// SPDX-License-Identifier: Apache-2.0
// Clock, UART, faults and watchdog of a board. The image restarts several times; the cause of each
// start says how far it has come. Echoes a line from the UART.
#include "condyle/cortex_m/board.h"
#include "semihosting.h"
#include "test_host.h"

namespace condyle::cross {
namespace {

using namespace condyle::cortex_m;

void require(bool holds, const char* what) {
  if (holds) return;
  print("failed: ");
  print(what);
  print("\n");
  end(1);
}

[[noreturn, gnu::noinline]] void run_into_fault() {
  __builtin_trap();
}
[[noreturn, gnu::noinline]] void hang() {
  for (;;) asm volatile("nop");
}
[[gnu::noinline]] std::uint32_t overflow_stack(std::uint32_t depth) {
  volatile std::uint32_t frame[64] = {depth};
  if (depth == 1'000'000) return 0;  // deeper than any stack
  return overflow_stack(depth + 1) + frame[depth % 64];
}

bool is_in(std::uint32_t pc, const void* function) {
  const auto begin = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(function)) & ~1U;
  return pc >= begin && pc < begin + 16;
}

void check_clock() {
  clock_start();
  TimeNs last_ns = now_ns();
  require(last_ns >= 0 && last_ns < 50'000'000, "the clock starts at 0");
  while (last_ns < 350'000'000) {  // over three of its periods
    const TimeNs next_ns = now_ns();
    require(next_ns >= last_ns, "the clock runs forwards");
    last_ns = next_ns;
  }
}

void echo_line() {
  uart_init(115'200);
  uart_write('>');
  for (std::uint8_t byte = 0; byte != '\n';) {
    uart_wait();
    if (uart_read(byte)) uart_write(byte);
  }
  const UartLosses losses = uart_losses();
  require(losses.ring_full == 0 && losses.overruns == 0, "no byte is lost");
}

// QEMU's watchdog takes the time of the host, and resets the board where a second period passes
// before the first one's end is seen: periods that a busy host does not use up.
void feed_watchdog_then_hang() {
  clock_start();
  watchdog_start(500);
  while (now_ns() < 1'500'000'000) watchdog_feed();
  hang();
}

}  // namespace
}  // namespace condyle::cross

int main() {
  using namespace condyle;
  using namespace condyle::cross;
  FaultRecord fault;
  const bool has_fault = last_fault(fault);
  switch (reset_cause()) {
    case ResetCause::power_on:
      require(!has_fault, "no fault before the first start");
      check_clock();
      echo_line();
      run_into_fault();
    case ResetCause::fault:
      require(has_fault, "a fault is kept");
      if (is_in(fault.pc, reinterpret_cast<const void*>(&run_into_fault))) {
        require(fault.exception == 3 && (fault.cfsr & 1U << 16U) != 0, "an undefined instruction");
        print("fault kept\n");
        restart();
      }
      // At once where nothing lies below the RAM. QEMU's mps2 lets the stack grow on and faults
      // when it returns. Either way there is no frame to take a pc from, and the record says so.
      require(fault.exception == 3 && fault.pc == 0, "a stack overflow is kept");
      print_hexadecimal("stack overflow kept: cfsr ", fault.cfsr);
      print("\n");
      end(0);
    case ResetCause::restart:
      require(!has_fault, "a restart is no fault");
      print("restarted\n");
      feed_watchdog_then_hang();
      break;
    case ResetCause::watchdog:
      require(has_fault && is_in(fault.pc, reinterpret_cast<const void*>(&hang)),
              "the watchdog says where the image hung");
      print("watchdog kept\n");
      end(static_cast<int>(overflow_stack(0)));
    case ResetCause::outside:
      require(false, "no other cause");
  }
}
