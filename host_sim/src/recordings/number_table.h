// SPDX-License-Identifier: Apache-2.0
// Tables of binary files: rows of numbers whose columns a TableLayout describes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "recordings/text_table.h"

namespace condyle::host {

/// Rows of numbers, in order.
class NumberRows {
 public:
  virtual ~NumberRows() = default;
  /// Next row into `row`, one number for each column of the layout; NaN: missing. False at the end.
  virtual bool next(std::vector<double>& row) = 0;
  /// Of the row last returned.
  virtual std::string place() const = 0;
  /// Share of the rows returned so far, 0 to 1.
  virtual double progress() const = 0;
};

/// The table `rows` as a recording.
std::unique_ptr<NamedPointsRecording> open_number_table(std::unique_ptr<NumberRows> rows,
                                                        TableFile file,
                                                        const RecordingOptions& options);

}  // namespace condyle::host
