// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "estimation/estimate_row.h"
#include "output/output_file.h"

namespace condyle::host {

/// Estimates as CSV: a row per sample, all digits, an empty field where nothing was computed.
class EstimatesFile {
 public:
  /// `axis_count`: 0 for the published cascade; else the recommended estimator's 1 or 3, whose
  /// columns follow those that both have. `has_joint`: the rows have a joint estimate, whose
  /// columns come last.
  EstimatesFile(const std::string& path, int axis_count, bool has_joint);
  void write_row(const EstimateRow& row);
  /// Writes out what is buffered.
  void close() { file_.close(); }
  /// Gives the closed file its name; without it, nothing is left.
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  int axis_count_;
  bool has_joint_;
  std::string row_;
};

}  // namespace condyle::host
