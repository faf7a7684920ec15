// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "commands/commands.h"
#include "condyle/hal/clock.h"
#include "condyle/hal/report/device_facebow.h"
#include "hosted/devices/session_device.h"

namespace condyle::host {

/// Shows the state of the recording while it runs.
class Monitor {
 public:
  Monitor(const hal::DeviceFacebow& facebow, const SessionDevice& device,
          const std::vector<std::unique_ptr<RecordedCompanion>>& companions, hal::Clock& clock)
      : facebow_(facebow),
        has_counter_(device.profile.sequence.has_value()),
        serial_(device.address.serial),
        companions_(companions),
        were_there_(companions.size(), true),
        clock_(clock),
        begin_ns_(clock.now_ns()) {}

  /// Call it often.
  void look() {
    const TimeNs now_ns = clock_.now_ns();
    if (facebow_.counts().received != received_) last_received_ns_ = now_ns;
    received_ = facebow_.counts().received;
    const std::uint64_t disconnections = facebow_.transport_counts().disconnections;
    if (disconnections > disconnections_) {
      disconnections_ = disconnections;
      say(now_ns, "the device was disconnected; waiting for it" +
                      (serial_.empty() ? "" : ", serial number " + serial_));
    }
    for (std::size_t i = 0; i < companions_.size(); ++i) {
      // In the first second the device is still being opened.
      const bool is_there = companions_[i]->companion.is_open() ||
                            (were_there_[i] && now_ns - begin_ns_ < 1'000'000'000);
      if (is_there == were_there_[i]) continue;
      were_there_[i] = is_there;
      say(now_ns, companions_[i]->profile.name +
                      (is_there ? " is back" : " is disconnected; waiting for it"));
    }
    if (!is_terminal_ || now_ns < next_ns_) return;
    next_ns_ = now_ns + 200'000'000;
    const hal::ReportCounts& counts = facebow_.counts();
    std::string text = fmt::format("\rrecording {:.1f} s, {} reports", seconds(now_ns - begin_ns_),
                                   counts.received);
    if (has_counter_) text += fmt::format(", {} lost ", counts.lost);
    std::fputs(text.c_str(), stderr);
    has_line_ = true;
  }
  void end_line() {
    if (has_line_) std::fputc('\n', stderr);
    has_line_ = false;
  }
  TimeNs elapsed_ns() const { return clock_.now_ns() - begin_ns_; }
  TimeNs idle_ns() const { return clock_.now_ns() - last_received_ns_; }

 private:
  void say(TimeNs now_ns, const std::string& words) {
    end_line();
    print_error(fmt::format("{:.3f} s: {}", seconds(now_ns - begin_ns_), words));
  }

  const hal::DeviceFacebow& facebow_;
  bool has_counter_;
  std::string serial_;
  const std::vector<std::unique_ptr<RecordedCompanion>>& companions_;
  std::vector<bool> were_there_;
  hal::Clock& clock_;
  TimeNs begin_ns_, next_ns_ = 0, last_received_ns_ = begin_ns_;
  std::uint64_t received_ = 0, disconnections_ = 0;
  bool is_terminal_ = isatty(STDERR_FILENO) != 0, has_line_ = false;
};

}  // namespace condyle::host
