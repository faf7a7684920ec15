// SPDX-License-Identifier: Apache-2.0
// Clock (SysTick) and watchdog.
#include <numeric>

#include "condyle/cortex_m/board.h"
#include "device.h"
#include "faults.h"

namespace condyle::cortex_m {
namespace {

constexpr std::uint32_t kPeriod_ticks = kClock_Hz / 10;  // 24 bits count it
// A tick in nanoseconds, as a fraction.
constexpr TimeNs kCommon = std::gcd(kNanosecondsPerSecond, TimeNs{kClock_Hz});
constexpr TimeNs kTickNumerator = kNanosecondsPerSecond / kCommon,
                 kTickDenominator = kClock_Hz / kCommon;
static_assert(kTickNumerator <= 1000 && kPeriod_ticks < 1U << 24U);
constexpr std::uint32_t kPending = 1U << 26U;  // of ICSR: the period is over, but not counted yet

constinit volatile std::uint32_t g_periods = 0;

}  // namespace

void clock_start() {
  reg(kSystCsr) = 0;
  g_periods = 0;
  reg(kSystRvr) = kPeriod_ticks - 1;
  reg(kSystCvr) = 0;
  reg(kSystCsr) = 7;  // on, with interrupt, from the core's clock
}

TimeNs now_ns() {
  std::uint32_t before = 0, periods = 0, left = 0;
  do {
    before = periods = g_periods;
    left = reg(kSystCvr);
    if ((reg(kIcsr) & kPending) != 0) {
      left = reg(kSystCvr);
      ++periods;
    }
  } while (before != g_periods);
  // The counter runs 0, kPeriod_ticks - 1, ..., 1; a period begins, and is signalled, at 0.
  const std::uint32_t ticks = left == 0 ? 0 : kPeriod_ticks - left;
  return (TimeNs{periods} * kPeriod_ticks + ticks) * kTickNumerator / kTickDenominator;
}

void watchdog_start(std::uint32_t period_ms) {
  enable_interrupt(kWatchdogInterrupt);
  Watchdog::start(period_ms);
}

void watchdog_feed() {
  Watchdog::feed();
}

}  // namespace condyle::cortex_m

extern "C" void systick_handler() {
  condyle::cortex_m::g_periods = condyle::cortex_m::g_periods + 1;
}
