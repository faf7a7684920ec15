// SPDX-License-Identifier: Apache-2.0
// CSV recordings: csv_layout.h says what their columns are, text_table.h reads their rows.
#include "recordings/csv_layout.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

std::unique_ptr<NamedPointsRecording> open(std::unique_ptr<ByteReader> reader,
                                           const RecordingOptions& options, bool takes_any_number) {
  TableFile file = csv_layout(start_of(*reader), reader->path(), options, takes_any_number);
  return open_table(std::move(reader), std::move(file), options);
}

}  // namespace

std::unique_ptr<Recording> open_csv(std::unique_ptr<ByteReader> reader,
                                    const RecordingOptions& options) {
  return open(std::move(reader), options, false);
}

std::unique_ptr<NamedPointsRecording> open_csv_points(std::unique_ptr<ByteReader> reader,
                                                      const RecordingOptions& options) {
  return open(std::move(reader), options, true);
}

}  // namespace condyle::host
