// SPDX-License-Identifier: Apache-2.0
// Recordings of jaw motion, whatever their format, as a sequence of samples.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"
#include "condyle/hal/status.h"
#include "hosted/devices/source_spec.h"

namespace condyle::host {

/// What to do with a row whose value is missing or not finite, or whose time runs backwards.
enum class FaultPolicy {
  refuse,  ///< an InputError that names the place
  event,   ///< a sample that is marked so, counted as an event
};

/// How to read a recording.
struct RecordingOptions {
  FaultPolicy faults = FaultPolicy::refuse;
  std::vector<std::string> ignored_columns;  ///< CSV columns that are not read
  bool may_lack_ignored = false;             ///< one of several recordings: not all have them
  std::optional<double> units_per_metre;     ///< 1000: mm; for formats that do not state their unit
  int movement = 1;                          ///< which movement of a Zebris XML file, from 1
  std::string profile;                       ///< TOML file with the profile of a device
  bool reads_drive_alone = false;            ///< drive without position; CSV only
  std::string drive_column = "drive_N";      ///< name of the drive's column; CSV only
};

/// What a recording says of itself.
struct RecordingInfo {
  std::string format;  ///< in words
  SampleKind kind = SampleKind::one_axis;
  bool has_drive = false;
  std::optional<TimeNs> nominal_step_ns;  ///< where the recording states it
  bool is_of_device = false;       ///< replayed as it was live: gaps as the profile's rate says
  std::string parameters_toml;     ///< that it was recorded with; may be empty
  std::vector<std::string> notes;  ///< what the user should know about how it was read
};

/// A recording being read. Problems of the file are InputErrors.
class Recording {
 public:
  virtual ~Recording() = default;
  /// Next sample; false at the end. What a device did between samples is passed over.
  virtual bool next(Sample& sample) = 0;
  /// The next sample or what came instead, as it was live: ok, bad_report, disconnected (the next
  /// call goes on) or end.
  virtual hal::Status read(Sample& sample) {
    return next(sample) ? hal::Status::ok : hal::Status::end;
  }
  virtual const RecordingInfo& info() const = 0;
  /// Where the sample last returned stands: "FILE:LINE", or the like for files without lines.
  virtual std::string place() const = 0;
  /// Share of the file read so far, 0 to 1; 0 if it is not known.
  virtual double progress() const = 0;
};

/// The source that `text` names (hosted/devices/source_spec.h). synth:SCENARIO, as sim:SCENARIO was
/// once written, still means that; the error output then says, once for each, how to write it.
SourceSpec recording_source(const std::string& text);

/// Opens `source`: "PATH" or "file:PATH", a recording, recognised by its content; or
/// "sim:SCENARIO.toml", simulated while it is read. An InputError for a device.
std::unique_ptr<Recording> open_recording(const std::string& source,
                                          const RecordingOptions& options);

}  // namespace condyle::host
