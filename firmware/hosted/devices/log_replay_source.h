// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "condyle/hal/clock.h"
#include "hosted/devices/log_device.h"

namespace condyle::host {

/// The facebow of a session log, played from now on at its recorded speed. Reports have times of
/// the clock on which it is played.
class LogReplaySource final : public hal::ReportSource {
 public:
  /// Throws an InputError if the log cannot be used.
  LogReplaySource(const std::string& path, hal::Clock& clock)
      : clock_(clock), recorded_(clock), device_(open_log_facebow(path, {}, &recorded_)) {}

  hal::Status open() override { return device_.reports->open(); }
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override;
  void close() override { device_.reports->close(); }
  hal::TransportCounts counts() const override { return device_.reports->counts(); }

  const LogDevice& device() const { return device_; }

 private:
  // The clock of the recording.
  class RecordedClock final : public hal::Clock {
   public:
    explicit RecordedClock(hal::Clock& clock) : clock_(clock) {}
    TimeNs now_ns() override { return clock_.now_ns() + ahead_ns; }
    void sleep_until(TimeNs time_ns) override { clock_.sleep_until(time_ns - ahead_ns); }

    TimeNs ahead_ns = 0;  // of the clock on which it is played

   private:
    hal::Clock& clock_;
  };

  hal::Clock& clock_;
  RecordedClock recorded_;
  LogDevice device_;
  bool has_begun_ = false;
};

}  // namespace condyle::host
