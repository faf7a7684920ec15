// SPDX-License-Identifier: Apache-2.0
#include "recordings/drive_channel.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "hosted/files/input_error.h"
#include "recordings/analog_channels.h"
#include "recordings/device_recording.h"

namespace condyle::host {
namespace {

constexpr std::string_view kAnalog = "analog:";

}  // namespace

DriveChannel::DriveChannel(std::string drive, FaultPolicy faults, const std::string& recording)
    : path_(std::move(drive)) {
  if (path_.starts_with(kAnalog)) {
    recording_ =
        open_analog_drive(recording_source(recording).file, path_.substr(kAnalog.size()), faults);
    return;
  }
  if (report_file_at(path_) == ReportFile::session_log) {
    recording_ = open_logged_drive(path_);
    return;
  }
  RecordingOptions options;
  options.faults = faults;
  options.reads_drive_alone = true;
  recording_ = open_recording(path_, options);
}

std::vector<std::string> DriveChannel::notes(TimeNs first_ns, TimeNs last_ns) {
  constexpr double kMostOfIt = 0.95;
  std::vector<std::string> notes = {
      fmt::format("drive: {}, {}: {} samples{}", path_, recording_->info().format, samples_,
                  missing_ > 0 ? fmt::format(", {} without a force", missing_) : "")};
  for (const std::string& note : recording_->info().notes) notes.push_back("drive: " + note);
  give_until(std::numeric_limits<TimeNs>::max(), [](TimeNs, double) {});
  if (!first_ns_ || last_ns < first_ns) return notes;
  const double from_s = seconds(std::max(first_ns, *first_ns_)),
               to_s = seconds(std::min(last_ns, *last_ns_)),
               duration_s = seconds(last_ns) - seconds(first_ns);
  const std::string spans =
      fmt::format("it covers {:g} to {:g} s, the recording {:g} to {:g} s", seconds(*first_ns_),
                  seconds(*last_ns_), seconds(first_ns), seconds(last_ns));
  if (to_s < from_s) {
    throw InputError(
        path_, spans + ": they have no time in common",
        "use one clock for both, or shift the times of one by the difference of the clocks");
  }
  if (to_s - from_s < kMostOfIt * duration_s) notes.push_back("drive: " + spans);
  return notes;
}

}  // namespace condyle::host
