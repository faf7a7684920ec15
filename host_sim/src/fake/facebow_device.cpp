// SPDX-License-Identifier: Apache-2.0
#include "fake/facebow_device.h"

#include <cmath>

namespace condyle::host::fake {

FacebowDevice::FacebowDevice(const DeviceOptions& options, Motion motion)
    : options_(options), motion_(std::move(motion)), counter_(options.first_counter) {}

bool FacebowDevice::next_report(TimeNs time_ns, FacebowReport& report) {
  ReportContent content;
  if (!motion_.next(content.coordinates)) return false;
  content.counter = counter_++;
  content.time_us = clock_us(time_ns);
  report = encode(content);
  return true;
}

void FacebowDevice::reconnect(TimeNs time_ns) {
  if (!options_.restarts_on_reconnect) return;
  counter_ = options_.first_counter;
  switched_on_ns_ = time_ns;
  clock_offset_ns_ = 0;
}

void FacebowDevice::jump_counter(std::int64_t step) {
  counter_ += static_cast<std::uint32_t>(step);
}

void FacebowDevice::jump_clock(TimeNs step_ns) {
  clock_offset_ns_ += step_ns;
}

std::uint32_t FacebowDevice::clock_us(TimeNs time_ns) const {
  const TimeNs since_on_ns = time_ns - switched_on_ns_;
  // Only the drift is computed in double: the full time would lose its nanoseconds.
  const TimeNs drift_ns =
      std::llround(static_cast<double>(since_on_ns) * options_.clock_drift_ppm * 1e-6);
  const TimeNs shown_ns = since_on_ns + drift_ns + clock_offset_ns_;
  const TimeNs shown_us = shown_ns >= 0 ? shown_ns / 1000 : -((-shown_ns + 999) / 1000);
  return options_.first_time_us +
         static_cast<std::uint32_t>(shown_us);  // wraps, as in a real device
}

}  // namespace condyle::host::fake
