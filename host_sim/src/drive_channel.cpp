// SPDX-License-Identifier: Apache-2.0
#include "drive_channel.h"

#include <fmt/format.h>

#include "byte_reader.h"
#include "device_recording.h"

namespace condyle::host {

DriveChannel::DriveChannel(std::string path, FaultPolicy faults) : path_(std::move(path)) {
  if (looks_like_session_log(ByteReader(path_).peek(8))) {
    recording_ = open_logged_drive(path_);
    return;
  }
  RecordingOptions options;
  options.faults = faults;
  options.reads_drive_alone = true;
  recording_ = open_recording(path_, options);
}

std::vector<std::string> DriveChannel::notes() const {
  std::vector<std::string> notes = {
      fmt::format("drive: {}, {}: {} samples{}", path_, recording_->info().format, samples_,
                  missing_ > 0 ? fmt::format(", {} without a force", missing_) : "")};
  for (const std::string& note : recording_->info().notes) notes.push_back("drive: " + note);
  return notes;
}

}  // namespace condyle::host
