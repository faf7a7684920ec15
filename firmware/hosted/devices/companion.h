// SPDX-License-Identifier: Apache-2.0
// An instrument beside the facebow, with its own rate and clock: a force sensor, an EMG amplifier.
#pragma once

#include <atomic>
#include <thread>

#include "condyle/hal/clock.h"
#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/device_facebow.h"

namespace condyle::host {

/// Reads a companion on a thread of its own, from start to stop, and opens it again when it went
/// away. Its samples are at times of the same host clock as the facebow's; the facebow's reading
/// does not wait for it.
class Companion {
 public:
  /// `source`: on `clock`; nobody else uses it between start and stop.
  Companion(hal::ReportSource& source, const hal::DeviceProfile& profile, hal::Clock& clock)
      : device_(source, hal::layout_of(profile)), clock_(clock) {}
  ~Companion() { stop(); }
  Companion(const Companion&) = delete;
  Companion& operator=(const Companion&) = delete;

  void start();
  /// May be called twice.
  void stop();
  /// Whether it could be read when it was last tried; any thread may ask.
  bool is_open() const { return is_open_; }
  /// Before start and after stop.
  const hal::DeviceFacebow& device() const { return device_; }

 private:
  void run();

  hal::DeviceFacebow device_;
  hal::Clock& clock_;
  std::atomic<bool> stops_ = false, is_open_ = false;
  std::thread thread_;
};

}  // namespace condyle::host
