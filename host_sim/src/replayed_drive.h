// SPDX-License-Identifier: Apache-2.0
// A drive of its own recording beside the samples of another.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "condyle/estimator/point_regression.h"
#include "condyle/estimator/sample.h"
#include "drive_channel.h"

namespace condyle::host {

/// A `Sensor` (one with `add_drive`) whose drive may come from a recording of its own.
template <class Sensor>
class ReplayedDriveSensor : public Sensor {
 public:
  /// `channel` may be null: the samples then hold the drive; `delay_s` is how late it is stamped.
  /// The rest makes the Sensor.
  template <class... Arguments>
  ReplayedDriveSensor(DriveChannel* channel, double delay_s, Arguments&&... arguments)
      : Sensor(std::forward<Arguments>(arguments)...),
        delay_ns_(nanoseconds(delay_s)),
        channel_(channel) {}

  /// As the Sensor's.
  typename Sensor::Estimate process(const Sample& sample, EventSet events) {
    if (channel_ != nullptr && sample.time_valid) {
      TimeNs stamped_ns = 0;  // of the drive at that instant
      if (__builtin_add_overflow(sample.time_ns, delay_ns_, &stamped_ns)) {
        stamped_ns = sample.time_ns;
      }
      channel_->give_until(stamped_ns, [this](TimeNs time_ns, double drive_N) {
        this->add_drive(time_ns, drive_N);
      });
    }
    return Sensor::process(sample, events);
  }

 private:
  TimeNs delay_ns_;
  DriveChannel* channel_;
};

/// For the summary: the channel's own notes, and what was not as it should be, a line each.
std::vector<std::string> drive_notes(const std::optional<DriveChannel>& channel,
                                     const DriveCounts& counts);

}  // namespace condyle::host
