// SPDX-License-Identifier: Apache-2.0
// A force recorded separately from the position, at its own rate.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recordings/recording.h"

namespace condyle::host {

/// The samples of a drive, in order, with one sample of look-ahead.
class DriveChannel {
 public:
  /// Opens `drive`: the path of a file, CSV with time_s and drive_N, or a session log, from which
  /// the first device with a drive is used; or "analog:NAME", an analogue channel of the recording
  /// at `recording`. Its times are on the clock of the positions.
  DriveChannel(std::string drive, FaultPolicy faults, const std::string& recording = "");

  /// Passes all samples up to the first at or after `time_ns` to `add(time_ns, force_N)`, each
  /// once; counts samples without time or force, and leaves them out. Problems of the file are
  /// InputErrors.
  template <class Add>
  void give_until(TimeNs time_ns, const Add& add) {
    while (!has_ended_ && !(last_ns_ && *last_ns_ >= time_ns)) {
      Sample sample;
      if (!recording_->next(sample)) {
        has_ended_ = true;
      } else if (!sample.time_valid || !sample.drive_valid) {
        ++missing_;
      } else {
        ++samples_;
        if (!first_ns_) first_ns_ = sample.time_ns;
        last_ns_ = sample.time_ns;
        add(sample.time_ns, sample.drive_N);
      }
    }
  }

  /// For the summary: its format, the number of samples, and how much it covers of the recording,
  /// which lasts from `first_ns` to `last_ns`; one line each. Reads to its end. Throws InputError
  /// if the two have no instant in common.
  std::vector<std::string> notes(TimeNs first_ns, TimeNs last_ns);

 private:
  std::string path_;
  std::unique_ptr<Recording> recording_;
  std::optional<TimeNs> first_ns_, last_ns_;
  bool has_ended_ = false;
  std::uint64_t samples_ = 0, missing_ = 0;
};

}  // namespace condyle::host
