// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "condyle/hal/clock.h"

namespace condyle::testing_support {

/// A manual clock for several threads: a thread that sleeps on it advances it and wakes at once.
class SharedManualClock final : public hal::Clock {
 public:
  TimeNs now_ns() override { return now_ns_; }
  void sleep_until(TimeNs time_ns) override {
    TimeNs before_ns = now_ns_;
    while (before_ns < time_ns && !now_ns_.compare_exchange_weak(before_ns, time_ns)) {
    }
  }

 private:
  std::atomic<TimeNs> now_ns_ = 0;
};

}  // namespace condyle::testing_support
