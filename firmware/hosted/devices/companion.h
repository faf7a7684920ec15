// SPDX-License-Identifier: Apache-2.0
// An instrument beside the facebow with its own rate and clock, such as a force sensor or an EMG
// amplifier.
#pragma once

#include <atomic>
#include <thread>

#include "condyle/hal/clock.h"
#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/device_facebow.h"

namespace condyle::host {

/// Reads a companion on its own thread from start to stop, and reopens it after a disconnection.
/// The times of its samples are on the same host clock as the facebow's. The facebow's reading
/// never waits for it.
class Companion {
 public:
  /// `source`: on `clock`; no other code uses it between start and stop.
  Companion(hal::ReportSource& source, const hal::DeviceProfile& profile, hal::Clock& clock)
      : device_(source, hal::layout_of(profile)), clock_(clock) {}
  ~Companion() { stop(); }
  Companion(const Companion&) = delete;
  Companion& operator=(const Companion&) = delete;

  void start();
  /// May be called twice.
  void stop();
  /// Whether the last attempt to read it succeeded; any thread may ask.
  bool is_open() const { return is_open_; }
  /// Call it before start or after stop.
  const hal::DeviceFacebow& device() const { return device_; }

 private:
  void run();

  hal::DeviceFacebow device_;
  hal::Clock& clock_;
  std::atomic<bool> stops_ = false, is_open_ = false;
  std::thread thread_;
};

}  // namespace condyle::host
