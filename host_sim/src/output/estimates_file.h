// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "estimation/estimate_row.h"
#include "output/output_file.h"

namespace condyle::host {

/// Estimates as CSV: one row for each sample, with all digits; a field is empty if the value was
/// not computed.
class EstimatesFile {
 public:
  using Row = EstimateRow;

  /// `axis_count`: 0 for the published cascade; otherwise the recommended estimator's 1 or 3, whose
  /// columns follow the common ones. `has_impedance`: the columns of an impedance estimate follow.
  /// `has_learning`: the shares of learned corrections come last.
  EstimatesFile(const std::string& path, int axis_count, bool has_impedance,
                bool has_learning = false);
  void write_row(const EstimateRow& row);
  /// Writes the buffer.
  void close() { file_.close(); }
  /// Renames the closed file to its final name; without this call no file remains.
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  int axis_count_;
  bool has_impedance_, has_learning_;
  std::string row_;
};

}  // namespace condyle::host
