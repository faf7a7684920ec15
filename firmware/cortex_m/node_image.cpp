// SPDX-License-Identifier: Apache-2.0
// The estimator as an image: reports in, estimates out, over the board's UART. CONDYLE_SCALAR: type
// of the numbers, as the core's FPU computes. CONDYLE_MOST_LAG: longest lag in samples for which
// the board has memory. CONDYLE_IDENTIFIES: whether the board has the memory for friction and mass,
// and a core that computes with double. CONDYLE_KERNELS: kernels for which it has the memory.
//
// CONDYLE_FAILS_AT: for a test, the filter fails at that sample, as in fail_node; if that returns,
// the filter's estimate is wrong.
#include <type_traits>

#include "condyle/cortex_m/board.h"
#include "condyle/firmware/estimator_node.h"

#ifdef CONDYLE_FAILS_AT
extern "C" void fail_node();
#endif

namespace condyle::cortex_m {
namespace {

constexpr std::uint32_t kBitsPerSecond = 1'000'000;
constexpr std::uint32_t kWatchdogPeriod_ms = 1000;

class UartStream final : public hal::ByteStream {
 public:
  hal::Status read(TimeNs deadline_ns, std::span<std::uint8_t> bytes, std::size_t& count) override {
    for (count = 0;;) {
      while (count < bytes.size() && uart_read(bytes[count])) ++count;
      if (count > 0) return hal::Status::ok;
      if (now_ns() >= deadline_ns) return hal::Status::timeout;
      uart_wait();  // SysTick ends the wait too, ten times a second
    }
  }
  hal::Status write(std::span<const std::uint8_t> bytes) override {
    uart_write(bytes.data(), bytes.size());
    return hal::Status::ok;
  }
};

hal::ResetCause words_of(ResetCause cause) {
  switch (cause) {
    case ResetCause::power_on:
      return hal::ResetCause::power_on;
    case ResetCause::restart:
      return hal::ResetCause::software;
    case ResetCause::fault:
      return hal::ResetCause::fault;
    case ResetCause::watchdog:
      return hal::ResetCause::watchdog;
    case ResetCause::outside:
      return hal::ResetCause::reset_pin;
  }
  return hal::ResetCause::unknown;
}

// Faults without their own handler arrive as a hard fault; CFSR gives their kind.
hal::FaultKind kind_of(const FaultRecord& record) {
  constexpr std::uint32_t kMemoryManagement = 0xFF, kBus = 0xFF00, kStacking = 0x1010,
                          kNonMaskable = 2;
  if (record.exception == kNonMaskable) return hal::FaultKind::non_maskable;
  if ((record.cfsr & kStacking) != 0) return hal::FaultKind::stack_overflow;
  if (record.cfsr == 0) return hal::FaultKind::hard;
  if ((record.cfsr & kMemoryManagement) != 0) return hal::FaultKind::memory_management;
  return (record.cfsr & kBus) != 0 ? hal::FaultKind::bus : hal::FaultKind::usage;
}

class Target final : public firmware::NodeTarget {
 public:
  hal::GreetingMessage greeting() override {
    hal::GreetingMessage greeting;
    greeting.software_version = hal::fixed_text(CONDYLE_VERSION);
    greeting.core_name = hal::fixed_text(CONDYLE_CORE_NAME);
    greeting.boot_count = start_count();
    greeting.reset_cause = words_of(reset_cause());
    return greeting;
  }

  std::optional<hal::FaultMessage> fault() override {
    FaultRecord record;
    if (!last_fault(record)) return std::nullopt;
    const bool is_watchdog = reset_cause() == ResetCause::watchdog;
    return hal::FaultMessage{.kind = is_watchdog ? hal::FaultKind::watchdog : kind_of(record),
                             .pc = record.pc,
                             .lr = record.lr,
                             .cfsr = record.cfsr,
                             .hfsr = record.hfsr,
                             .bfar = record.bfar};
  }

  void add_to(hal::HealthMessage& health) override {
    const UartLosses losses = uart_losses();
    health.uart_overruns = losses.overruns;
    health.dropped_bytes = losses.ring_full;
    health.stack_used_bytes = static_cast<std::uint32_t>(stack_used_bytes());
    health.stack_size_bytes = static_cast<std::uint32_t>(stack_size_bytes());
  }

  void feed_watchdog() override { watchdog_feed(); }
};

#ifdef CONDYLE_FAILS_AT
template <class Sensor>
class FailingSensor final : public Sensor {
 public:
  using Sensor::Sensor;
  typename Sensor::Estimate process(const Sample& sample, EventSet events) {
    const bool fails = ++samples_ == CONDYLE_FAILS_AT;
    if (fails) fail_node();
    auto estimate = Sensor::process(sample, events);
    estimate.events.add(Event::position_frozen, fails);
    return estimate;
  }

 private:
  int samples_ = 0;
};
using Node = firmware::EstimatorNode<CONDYLE_SCALAR, FailingSensor, CONDYLE_MOST_LAG, false, 0>;
#else
using Node = firmware::EstimatorNode<CONDYLE_SCALAR, std::type_identity_t, CONDYLE_MOST_LAG,
                                     CONDYLE_IDENTIFIES, CONDYLE_KERNELS>;
#endif

constinit UartStream g_line;
constinit BoardClock g_clock;
constinit Target g_target;
Node g_node(g_line, g_clock, g_target);  // too large for the stack

}  // namespace
}  // namespace condyle::cortex_m

int main() {
  using namespace condyle::cortex_m;
  clock_start();
  uart_init(kBitsPerSecond);
  watchdog_start(kWatchdogPeriod_ms);
  g_node.serve();
  return 0;
}
