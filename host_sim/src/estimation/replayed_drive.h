// SPDX-License-Identifier: Apache-2.0
// Combines a drive from one recording with the samples of another.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "condyle/estimator/impedance/point_regression.h"
#include "condyle/estimator/sample.h"
#include "recordings/drive_channel.h"

namespace condyle::host {

/// Times of some samples.
struct TimeSpan {
  TimeNs first_ns = std::numeric_limits<TimeNs>::max();
  TimeNs last_ns = std::numeric_limits<TimeNs>::min();
  bool is_empty() const { return last_ns < first_ns; }
};

/// See ReplayedDriveSensor::notes; `channel` may be null.
std::vector<std::string> drive_notes(DriveChannel* channel, const DriveCounts& counts,
                                     const TimeSpan& span);

/// A `Sensor` (one with `add_drive`) whose drive may come from a separate recording.
template <class Sensor>
class ReplayedDriveSensor : public Sensor {
 public:
  /// `channel` may be null: the samples then contain the drive; `delay_s`: delay of its time
  /// stamps. The other arguments construct the Sensor.
  template <class... Arguments>
  ReplayedDriveSensor(DriveChannel* channel, double delay_s, Arguments&&... arguments)
      : Sensor(std::forward<Arguments>(arguments)...),
        delay_ns_(nanoseconds(delay_s)),
        channel_(channel) {}

  /// As the Sensor's.
  typename Sensor::Estimate process(const Sample& sample, EventSet events) {
    if (sample.time_valid) {
      span_.first_ns = std::min(span_.first_ns, sample.time_ns);
      span_.last_ns = std::max(span_.last_ns, sample.time_ns);
    }
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

  /// For the summary: the channel's own notes, and problems of the drive, one line each. Throws
  /// InputError if the channel and the samples have no instant in common.
  std::vector<std::string> notes() const { return drive_notes(channel_, this->counts(), span_); }

 private:
  TimeSpan span_;
  TimeNs delay_ns_;
  DriveChannel* channel_;
};

}  // namespace condyle::host
