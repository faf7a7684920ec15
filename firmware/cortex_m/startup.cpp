// SPDX-License-Identifier: Apache-2.0
// From reset to main.
#include <cstdint>

#include "condyle/cortex_m/board.h"
#include "device.h"
#include "faults.h"

// C++ forbids calling `main` by its name.
int image_main() asm("main");

extern "C" {
// Defined by the linker script.
extern std::uint32_t data_begin[], data_end[], bss_begin[], bss_end[];
extern std::uint32_t stack_begin[], stack_end[];
extern const std::uint32_t data_in_flash[];
using Constructor = void (*)();
extern const Constructor init_array_begin[], init_array_end[];

// Classes with virtual functions refer to it; nothing calls it.
[[noreturn]] void __cxa_pure_virtual() {
  __builtin_trap();
}

[[noreturn, gnu::used]] void start_image() {
  const std::uint32_t* from = data_in_flash;
  for (std::uint32_t* to = data_begin; to != data_end;) *to++ = *from++;
  for (std::uint32_t* to = bss_begin; to != bss_end;) *to++ = 0;
  for (const Constructor* each = init_array_begin; each != init_array_end;) (*each++)();
  condyle::cortex_m::begin_run();
  image_main();
  condyle::cortex_m::restart();
}

// Fills the stack with a pattern before it is used. Enables the FPU before any C++, because a
// function may save FPU registers first.
[[gnu::naked]] void reset_handler() {
  asm volatile(
      "ldr r0, =0xE000ED88\n"  // CPACR
      "ldr r1, [r0]\n"
      "orr r1, r1, #0xF00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "ldr r0, =stack_begin\n"
      "ldr r1, =stack_end\n"
      "mov sp, r1\n"
      "ldr r2, =0xDEADBEEF\n"
      "1: str r2, [r0], #4\n"
      "cmp r0, r1\n"
      "bne 1b\n"
      "b start_image\n"
      ".ltorg\n");
}
}

namespace condyle::cortex_m {
namespace {

using Handler = void (*)();
struct VectorTable {
  const std::uint32_t* stack;
  Handler exceptions[15];  // from 1, reset, to 15, SysTick
  Handler interrupts[64];
};

constexpr VectorTable vector_table() {
  VectorTable table{};
  table.stack = stack_end;
  for (Handler& each : table.exceptions) each = fault_handler;
  for (Handler& each : table.interrupts) each = fault_handler;
  table.exceptions[0] = reset_handler;
  table.exceptions[14] = systick_handler;
  table.interrupts[kUartInterrupt] = uart_handler;
  return table;
}

}  // namespace

extern const VectorTable kVectors;
[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable kVectors = vector_table();

std::size_t stack_used_bytes() {
  const volatile std::uint32_t* deepest = stack_begin;
  while (deepest != stack_end && *deepest == 0xDEADBEEF) ++deepest;
  return (reinterpret_cast<std::uintptr_t>(stack_end) - reinterpret_cast<std::uintptr_t>(deepest));
}

std::size_t stack_size_bytes() {
  return reinterpret_cast<std::uintptr_t>(stack_end) -
         reinterpret_cast<std::uintptr_t>(stack_begin);
}

}  // namespace condyle::cortex_m
