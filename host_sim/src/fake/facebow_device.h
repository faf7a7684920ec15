// SPDX-License-Identifier: Apache-2.0
// The fake facebow between its sensor and its USB plug: counter, clock and report k.
#pragma once

#include <cstdint>

#include "condyle/estimator/sample.h"
#include "fake/motion.h"
#include "hosted/devices/facebow_report.h"

namespace condyle::host::fake {

/// How the device counts.
struct DeviceOptions {
  std::uint32_t first_counter = 0;
  std::uint32_t first_time_us = 0;     ///< what its clock shows when it is switched on
  double clock_drift_ppm = 0;          ///< its clock runs fast by
  bool restarts_on_reconnect = false;  ///< counter and clock start anew when plugged in; else a
                                       ///< battery keeps them going
};

/// A facebow that sends one report a row of its motion.
class FacebowDevice {
 public:
  FacebowDevice(const DeviceOptions& options, Motion motion);

  /// The next report, measured `time_ns` after the device was first switched on; the counter moves
  /// on. False if the motion is at its end. InputErrors as Motion::next.
  bool next_report(TimeNs time_ns, FacebowReport& report);

  /// The device was plugged in again at `time_ns`.
  void reconnect(TimeNs time_ns);
  /// A fault: the counter jumps by `step`, also backwards.
  void jump_counter(std::int64_t step);
  /// A fault: the clock jumps by `step_ns`, also backwards.
  void jump_clock(TimeNs step_ns);

  /// Counter of the next report.
  std::uint32_t counter() const { return counter_; }
  const Motion& motion() const { return motion_; }

 private:
  std::uint32_t clock_us(TimeNs time_ns) const;

  DeviceOptions options_;
  Motion motion_;
  std::uint32_t counter_;
  TimeNs switched_on_ns_ = 0;
  TimeNs clock_offset_ns_ = 0;  // by jumps
};

}  // namespace condyle::host::fake
