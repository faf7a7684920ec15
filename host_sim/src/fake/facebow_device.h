// SPDX-License-Identifier: Apache-2.0
// The electronics of the fake facebow: counter, clock and reports.
#pragma once

#include <cstdint>

#include "condyle/estimator/sample.h"
#include "fake/motion.h"
#include "hosted/devices/facebow_report.h"

namespace condyle::host::fake {

/// How the device counts.
struct DeviceOptions {
  std::uint32_t first_counter = 0;
  std::uint32_t first_time_us = 0;     ///< reading of its clock at power-on
  double clock_drift_ppm = 0;          ///< rate by which its clock runs fast
  bool restarts_on_reconnect = false;  ///< counter and clock restart; otherwise they run on
};

/// A facebow that sends one report for each row of its motion.
class FacebowDevice {
 public:
  FacebowDevice(const DeviceOptions& options, Motion motion);

  /// The next report, measured `time_ns` after the device was first switched on; the counter
  /// increases. False at the end of the motion. InputErrors as Motion::next.
  bool next_report(TimeNs time_ns, FacebowReport& report);

  /// The device was plugged in again at `time_ns`.
  void reconnect(TimeNs time_ns);
  /// A fault: the counter jumps by `step`, which may be negative.
  void jump_counter(std::int64_t step);
  /// A fault: the clock jumps by `step_ns`, which may be negative.
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
