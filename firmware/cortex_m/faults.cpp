// SPDX-License-Identifier: Apache-2.0
// Handles faults, and reports after a restart what caused it.
#include "faults.h"

#include <type_traits>

#include "condyle/cortex_m/board.h"
#include "device.h"

namespace condyle::cortex_m {
namespace {

// In memory that startup does not clear.
struct KeptMemory {
  static constexpr std::uint32_t kMagic = 0x636F6E64;  // any other value is random, from power-on
  std::uint32_t magic;
  ResetCause next_cause;
  std::uint32_t starts;  // since power-on
  FaultRecord fault;
};
static_assert(std::is_trivially_copyable_v<KeptMemory> && sizeof(KeptMemory) <= 256);

constinit ResetCause g_cause = ResetCause::power_on;
constinit FaultRecord g_fault;

}  // namespace
}  // namespace condyle::cortex_m

extern "C" condyle::cortex_m::KeptMemory kept_memory;

namespace condyle::cortex_m {

void begin_run() {
  if (kept_memory.magic == KeptMemory::kMagic) {
    g_cause = kept_memory.next_cause;
    g_fault = kept_memory.fault;
  } else {
    kept_memory.starts = 0;
  }
  ++kept_memory.starts;
  kept_memory.fault = {};
  kept_memory.next_cause = ResetCause::outside;
  kept_memory.magic = KeptMemory::kMagic;
}

std::uint32_t start_count() {
  return kept_memory.starts;
}

ResetCause reset_cause() {
  return g_cause;
}

bool last_fault(FaultRecord& record) {
  if (g_cause != ResetCause::fault && g_cause != ResetCause::watchdog) return false;
  record = g_fault;
  return true;
}

namespace {

[[noreturn]] void reset(ResetCause cause) {
  kept_memory.next_cause = cause;
  asm volatile("dsb" ::: "memory");
  reg(kAircr) = 0x05FA0004;  // SYSRESETREQ, with its key
  asm volatile("dsb" ::: "memory");
  for (;;) {
  }
}

}  // namespace

void restart() {
  reset(ResetCause::restart);
}

}  // namespace condyle::cortex_m

extern "C" {
extern const std::uint32_t stack_begin[], stack_end[];

// `frame`: the registers that the core has pushed: r0-r3, r12, lr, pc, psr.
[[noreturn, gnu::used]] void keep_fault(const std::uint32_t* frame, std::uint32_t exception) {
  using namespace condyle::cortex_m;
  // After a stack overflow there is no frame.
  const bool has_frame = frame >= stack_begin && frame + 8 <= stack_end;
  kept_memory.fault = {
      exception, has_frame ? frame[6] : 0, has_frame ? frame[5] : 0, reg(kCfsr), reg(kHfsr),
      reg(kBfar)};
  const bool is_watchdog = static_cast<int>(exception) == kWatchdogInterrupt + 16;
  reset(is_watchdog ? ResetCause::watchdog : ResetCause::fault);
}

// The present stack may be exhausted: start again at its top, because nothing returns.
[[gnu::naked]] void fault_handler() {
  asm volatile(
      "mov r0, sp\n"
      "mrs r1, ipsr\n"
      "ldr r2, =stack_end\n"
      "mov sp, r2\n"
      "b keep_fault\n"
      ".ltorg\n");
}
}
