// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <mutex>

#include "condyle/hal/clock.h"

namespace condyle::testing_support {

/// A clock for threads with a schedule, in tests that must not depend on the threads' speed. It
/// runs `speed` times as fast as the machine's up to the time it is allowed to show, and from there
/// a hundred times slower: a slow thread can catch up, and a waiting thread does not wait for ever.
class PacedClock final : public hal::Clock {
 public:
  explicit PacedClock(double speed, TimeNs origin_ns = 0)
      : speed_(speed), now_ns_(origin_ns), limit_ns_(origin_ns), machine_ns_(machine_.now_ns()) {}

  TimeNs now_ns() override {
    const std::lock_guard lock(mutex_);
    return advance();
  }
  void sleep_until(TimeNs time_ns) override {
    for (;;) {
      double wait_ns = 0;
      {
        const std::lock_guard lock(mutex_);
        const TimeNs left_ns = time_ns - advance();
        if (left_ns <= 0) return;
        wait_ns = static_cast<double>(left_ns) / (speed_ * (now_ns_ < limit_ns_ ? 1 : kCrawl));
      }
      // Not too long, because the allowed time may change.
      machine_.sleep_until(machine_.now_ns() +
                           static_cast<TimeNs>(std::clamp(wait_ns, kShortest_ns, kLongest_ns)));
    }
  }

  /// Allows it to show this much more time.
  void allow(TimeNs duration_ns) {
    const std::lock_guard lock(mutex_);
    limit_ns_ = advance() + duration_ns;
  }

 private:
  static constexpr double kCrawl = 0.01;
  static constexpr double kShortest_ns = 20e3, kLongest_ns = 2e6;

  TimeNs advance() {
    const TimeNs before_ns = machine_ns_;
    machine_ns_ = machine_.now_ns();
    const double passed_ns = speed_ * static_cast<double>(machine_ns_ - before_ns);
    const double allowed_ns = static_cast<double>(std::max<TimeNs>(0, limit_ns_ - now_ns_));
    const double fast_ns = std::min(passed_ns, allowed_ns);
    rest_ns_ += fast_ns + kCrawl * (passed_ns - fast_ns);
    const auto whole_ns = static_cast<TimeNs>(rest_ns_);
    rest_ns_ -= static_cast<double>(whole_ns);
    return now_ns_ += whole_ns;
  }

  const double speed_;
  hal::SteadyClock machine_;
  std::mutex mutex_;
  TimeNs now_ns_, limit_ns_, machine_ns_;
  double rest_ns_ = 0;  // less than one, to be added to now_ns_
};

}  // namespace condyle::testing_support
