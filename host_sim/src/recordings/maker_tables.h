// SPDX-License-Identifier: Apache-2.0
// Text formats of makers of instruments: a header of their own, then a table.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/text_table.h"

namespace condyle::host {

/// The recording in `reader` if it is one of the formats below, which then owns it; otherwise null,
/// and `reader` is where it was. Throws InputError for a format that is known and not read.
std::unique_ptr<NamedPointsRecording> open_maker_table(std::unique_ptr<ByteReader>& reader,
                                                       const RecordingOptions& options);

/// The beginning of a file that a format looks at.
struct MakerFile {
  TableStart start;
  const std::string& path;
  const RecordingOptions& options;
  std::size_t first_line = 0;  ///< lines of the file before `start`

  /// "PATH:LINE" of the line `index` of `start`.
  std::string place(std::size_t index) const;
  /// The fields of line `index`, none if there is no such line.
  std::vector<std::string_view> fields(std::size_t index, char separator) const;
  /// `text` as a positive number of frames per second; throws InputError.
  double rate_Hz(std::string_view text, std::size_t index) const;
  /// Metres in one of the unit of --unit, or that the file states.
  double metres_each(std::string_view unit, std::size_t index) const;
};

/// Motion Analysis TRC; also as OpenSim and others write it.
std::optional<TableFile> read_trc(const MakerFile& file);
/// Qualisys TSV of 3D data, with its header.
std::optional<TableFile> read_qualisys_tsv(const MakerFile& file);
/// OptiTrack Motive CSV, format 1.2 and later.
std::optional<TableFile> read_motive_csv(const MakerFile& file);
/// NDI First Principles text with its header.
std::optional<TableFile> read_ndi_text(const MakerFile& file);
/// Vicon Nexus CSV, from the line "Trajectories" on.
std::optional<TableFile> read_vicon_csv(const MakerFile& file);
/// Motion-BIDS: "..._motion.tsv" beside "..._channels.tsv" and "..._motion.json".
std::optional<TableFile> read_motion_bids(const MakerFile& file);

/// Gives the rows of `file` their times: from the column `frame` and the rate that the file states,
/// or from the column `time` if its times do not follow that rate.
void use_rate(TableFile& table, const MakerFile& file, std::optional<std::size_t> frame,
              std::optional<std::size_t> time, double rate_Hz);

}  // namespace condyle::host
