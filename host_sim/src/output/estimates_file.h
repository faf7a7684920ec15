// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "estimation/estimate_row.h"
#include "estimation/resampled_rows.h"
#include "output/output_file.h"
#include "output/table_form.h"

namespace condyle::host {

/// Estimates as CSV: one row for each sample, with all digits; a field is empty if the value was
/// not computed.
class EstimatesFile {
 public:
  using Row = EstimateRow;

  /// `axis_count`: 0 for the published cascade; otherwise the recommended estimator's 1 or 3, whose
  /// columns follow the common ones. `has_impedance`: friction and mass are identified, and the
  /// other columns of an impedance estimate follow. `has_learning`: the shares of learned
  /// corrections come last. Only the recommended estimator's rows can be resampled.
  EstimatesFile(const std::string& path, int axis_count, bool has_impedance,
                const TableForm& form = {}, bool has_learning = false);
  void write_row(const EstimateRow& row);
  bool has_reader() const { return file_.has_reader(); }
  /// Writes the buffer.
  void close() { file_.close(); }
  /// Renames the closed file to its final name; without this call no file remains.
  void commit() { file_.commit(); }

 private:
  void write(const EstimateRow& row);

  OutputFile file_;
  int axis_count_;
  bool has_impedance_, has_learning_;
  TableForm form_;
  std::optional<ResampledRows> resampled_;
  std::string row_;
};

}  // namespace condyle::host
