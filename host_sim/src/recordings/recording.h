// SPDX-License-Identifier: Apache-2.0
// Recordings of jaw motion in any format, as a sequence of samples.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "condyle/estimator/sample.h"
#include "condyle/hal/status.h"
#include "hosted/devices/source_spec.h"
#include "recordings/filled_numbers.h"

namespace condyle::host {

/// What to do with a row whose value is missing or not finite, or whose time runs backwards.
enum class FaultPolicy {
  refuse,  ///< throws an InputError that names the place
  event,   ///< a marked sample, counted as an event
};

/// How to read a recording.
struct RecordingOptions {
  FaultPolicy faults = FaultPolicy::refuse;
  std::vector<std::string> ignored_columns;  ///< CSV columns that are not read
  bool may_lack_ignored = false;             ///< one of several recordings may lack them
  std::vector<std::string> columns;          ///< NEW=OLD: names for the columns of a CSV file
  std::optional<double> rate_Hz;             ///< frames per second; for files without times
  std::optional<double> units_per_metre;     ///< 1000: mm; for formats that do not state their unit
  MissingNumbers missing;                    ///< which numbers stand for missing places
  int movement = 1;                          ///< which movement of a Zebris XML file, from 1
  std::string profile;                       ///< TOML file with the profile of a device
  std::vector<std::string> markers;          ///< points to read, by name; empty: not chosen
  bool reads_drive_alone = false;            ///< drive without position; CSV and analogue channels
  std::string drive_column = "drive_N";      ///< name of the drive's column or analogue channel
};

/// A channel that a file of points has beside them, at its own rate.
struct AnalogChannel {
  std::string name, unit;  ///< as in the file; the unit may be empty
  double rate_Hz = 0;
};

/// An instant that a file names.
struct NamedInstant {
  double time_s = 0;  ///< on the recording's clock
  std::string name;
};

/// What a file states about itself; `condyle info` shows it. Texts are as in the file.
struct FileStatement {
  std::string maker;  ///< program or instrument that wrote it; empty: not stated
  std::string unit;   ///< of its positions; empty: not stated
  std::optional<std::uint64_t> frames;
  std::optional<double> rate_Hz;
  std::vector<AnalogChannel> channels;
  std::vector<NamedInstant> events;
};

/// Properties of a recording.
struct RecordingInfo {
  std::string format;  ///< as text
  SampleKind kind = SampleKind::one_axis;
  bool has_drive = false;
  std::optional<TimeNs> nominal_step_ns;  ///< if the recording states it
  bool is_of_device = false;              ///< replayed as live: the profile's rate determines gaps
  std::string parameters_toml;            ///< of the live estimator; may be empty
  std::string begun_with_json;            ///< what it began with (learned_motion.h); may be empty
  std::vector<std::string> notes;         ///< notes for the user on how it was read
  FileStatement stated;                   ///< by the file, where its format has such statements
};

/// A recording being read. Problems of the file are InputErrors.
class Recording {
 public:
  virtual ~Recording() = default;
  /// Next sample; false at the end. Skips other events of a device.
  virtual bool next(Sample& sample) = 0;
  /// The next sample or event, as live: ok, bad_report, disconnected (the next call continues) or
  /// end.
  virtual hal::Status read(Sample& sample) {
    return next(sample) ? hal::Status::ok : hal::Status::end;
  }
  virtual const RecordingInfo& info() const = 0;
  /// Place of the sample last returned: "FILE:LINE", or similar for files without lines.
  virtual std::string place() const = 0;
  /// Share of the file read so far, 0 to 1; 0 if it is not known.
  virtual double progress() const = 0;
};

/// The source that `text` names (hosted/devices/source_spec.h). synth:SCENARIO, the old form of
/// sim:SCENARIO, still works; a note on the error output gives the new form, once for each.
SourceSpec recording_source(const std::string& text);

/// Opens `source`: "PATH" or "file:PATH", a recording, recognised by its content; or
/// "sim:SCENARIO.toml", simulated while it is read. "A+B+C" joins three recordings of one point
/// each into one of three points. Throws InputError for a device.
std::unique_ptr<Recording> open_recording(const std::string& source,
                                          const RecordingOptions& options);

}  // namespace condyle::host
