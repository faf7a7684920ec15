// SPDX-License-Identifier: Apache-2.0
// The clock is passed in, so that a replay or a test controls the time.
#pragma once

#include "condyle/estimator/sample.h"

namespace condyle::hal {

/// A monotonic clock.
class Clock {
 public:
  /// Nanoseconds since a fixed origin.
  virtual TimeNs now_ns() = 0;
  /// Returns once `time_ns` has come; at once if it has passed.
  virtual void sleep_until(TimeNs time_ns) = 0;

 protected:
  ~Clock() = default;  // not virtual: clocks are never deleted through this interface
};

/// The machine's monotonic clock.
class SteadyClock final : public Clock {
 public:
  TimeNs now_ns() override;
  void sleep_until(TimeNs time_ns) override;
};

/// A clock that moves only when it is set or slept on.
class ManualClock final : public Clock {
 public:
  TimeNs now_ns() override { return now_ns_; }
  void sleep_until(TimeNs time_ns) override { now_ns_ = time_ns > now_ns_ ? time_ns : now_ns_; }

 private:
  TimeNs now_ns_ = 0;
};

}  // namespace condyle::hal
