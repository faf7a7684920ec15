// SPDX-License-Identifier: Apache-2.0
// The files of a BIDS data set that recordings are added to.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "exports/export_format.h"

namespace condyle::host {

/// Keys keep their order.
using BidsJson = nlohmann::ordered_json;

/// A channel: one column of a table without a header.
struct BidsChannel {
  std::string name, component = "n/a", type, point = "n/a", unit = "n/a", description = {};
};

/// A recording in a data set.
class BidsDataset {
 public:
  /// Adds to `exported` the files of the data set `out` that are missing. Throws InputError if
  /// `labels` name no recording, if the data set holds it already, or if `out` is another folder.
  BidsDataset(const std::string& out, const BidsLabels& labels, const std::string& source,
              Exported& exported);

  const std::string& task() const { return labels_.task; }
  /// A file of measurements with this `end`, "_motion.tsv".
  OutputFile& measured_file(const std::string& end);
  /// A file of estimates, whose name also gets desc-estimates.
  OutputFile& estimated_file(const std::string& end);

  /// Writes and closes a file.
  static void write_json(OutputFile& file, const BidsJson& content);
  /// _channels.tsv.
  static void write_channels(OutputFile& file, const std::vector<BidsChannel>& channels,
                             double rate_Hz);

 private:
  OutputFile& file(const std::string& path);
  void make_folder(const std::string& path);
  void add_participant(const std::string& out);

  BidsLabels labels_;
  Exported& exported_;
  std::string measured_, estimated_;  // paths without ends
  std::string derivatives_;           // folder of the estimates
};

/// The unit as BIDS writes it: "m/s^2" of "m_s2".
std::string bids_unit(const std::string& unit);

/// `text` fit for a cell of a table whose cells are separated by tabs; empty text becomes "n/a".
std::string bids_cell(const std::string& text);

}  // namespace condyle::host
