// SPDX-License-Identifier: Apache-2.0
// A force that was recorded apart from the position, with its own rate.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recordings/recording.h"

namespace condyle::host {

/// The samples of a drive, in order, each looked at before it is due.
class DriveChannel {
 public:
  /// Opens the drive in the file `path`: CSV with time_s and drive_N, or a session log, of which
  /// the first device with a drive is taken. Its times are on the clock of the positions.
  DriveChannel(std::string path, FaultPolicy faults);

  /// Gives all samples up to the first at or after `time_ns` to `add(time_ns, force_N)`, each once;
  /// samples without time or force are counted and left out. Problems of the file are InputErrors.
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

  /// For the summary: what it is, how much came, and how much of the recording, which lasts from
  /// `first_ns` to `last_ns`, it covers; a line each. Reads to its end. Throws InputError where the
  /// two have no instant in common.
  std::vector<std::string> notes(TimeNs first_ns, TimeNs last_ns);

 private:
  std::string path_;
  std::unique_ptr<Recording> recording_;
  std::optional<TimeNs> first_ns_, last_ns_;
  bool has_ended_ = false;
  std::uint64_t samples_ = 0, missing_ = 0;
};

}  // namespace condyle::host
