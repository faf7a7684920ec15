// SPDX-License-Identifier: Apache-2.0
// The formats behind open_recording.
#pragma once

#include <memory>
#include <string_view>

#include "hosted/files/byte_reader.h"
#include "hosted/files/number_text.h"
#include "recordings/recording.h"

namespace condyle::host {

/// CSV whose first line names the columns with their units.
std::unique_ptr<Recording> open_csv(std::unique_ptr<ByteReader> reader,
                                    const RecordingOptions& options);
/// ArtiSynth probe text: two header lines, then columns of numbers. The JAWS3D recordings have this
/// form, and tracks of Zebris instruments that were converted for ArtiSynth.
std::unique_ptr<Recording> open_probe_text(std::unique_ptr<ByteReader> reader,
                                           const RecordingOptions& options);
/// SSFF, the Emu Speech Database's binary track format, with columns *posx, *posy, *posz.
std::unique_ptr<Recording> open_ssff(std::unique_ptr<ByteReader> reader,
                                     const RecordingOptions& options);
/// Zebris XML export. Reads only the tracks.
std::unique_ptr<Recording> open_zebris_xml(std::unique_ptr<ByteReader> reader,
                                           const RecordingOptions& options);

/// The file at `path`, recognised by its content.
std::unique_ptr<Recording> open_recording_file(const std::string& path,
                                               const RecordingOptions& options);
/// `source` names several files (recordings/recording_files.h): three of one point each.
std::unique_ptr<Recording> open_joined(const std::string& source, RecordingOptions options);

/// Rows of a text format. Blank lines at the end of the file are ignored; blank lines before a row
/// are rows without values.
class RowReader {
 public:
  /// `separator`: a line of separators alone is blank too. `has_comments`: lines that begin with #
  /// or % are not rows.
  explicit RowReader(ByteReader& reader, char separator = ' ', bool has_comments = false)
      : reader_(reader), separator_(separator), has_comments_(has_comments) {}
  /// Next row; false at the end. `row` is empty for a blank line, otherwise valid until the next
  /// call.
  bool next(std::string_view& row);
  /// Line of the row last returned.
  std::uint64_t line() const { return line_; }

 private:
  ByteReader& reader_;
  char separator_;
  bool has_comments_;
  std::optional<std::string_view> held_;  // valid until the reader moves on
  std::uint64_t blank_rows_ = 0;          // before the held row
  std::uint64_t line_ = 0;
};

/// Fields of a row of CSV, without spaces and quotes around them, into `fields`, whose memory is
/// reused for each row.
void split_row(std::string_view row, std::vector<std::string_view>& fields);

/// True if `start`, the beginning of a file, has the two header lines of ArtiSynth probe text.
bool looks_like_probe_text(std::string_view start);

/// Time of row `index` of a recording with regular steps. Throws an InputError that names `path` if
/// it is out of the range of times.
TimeNs regular_time_ns(TimeNs start_ns, std::uint64_t index, double step_s,
                       const std::string& path);

/// Converts the status of reading one value into a usable number, a mark on the sample, or an
/// error.
class FaultRule {
 public:
  explicit FaultRule(FaultPolicy policy) : policy_(policy) {}
  /// True if `status` is ok. Otherwise: false for an empty or non-finite value under
  /// FaultPolicy::event, an InputError naming `place` and `column` for everything else.
  bool accept(NumberStatus status, const std::string& place, std::string_view column,
              std::string_view text) const;

 private:
  FaultPolicy policy_;
};

}  // namespace condyle::host
