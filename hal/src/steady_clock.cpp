// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <thread>

#include "condyle/hal/clock.h"

namespace condyle::hal {

TimeNs SteadyClock::now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void SteadyClock::sleep_until(TimeNs time_ns) {
  std::this_thread::sleep_until(
      std::chrono::steady_clock::time_point(std::chrono::nanoseconds(time_ns)));
}

}  // namespace condyle::hal
