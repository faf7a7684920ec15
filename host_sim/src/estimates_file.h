// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "condyle/estimator/published_cascade.h"
#include "condyle/estimator/sample.h"
#include "output_file.h"

namespace condyle::host {

/// Estimates as CSV: a row per sample, all digits, an empty field where nothing was computed.
class EstimatesFile {
 public:
  explicit EstimatesFile(const std::string& path);
  void write_row(const Sample& sample, const PublishedEstimate<double>& estimate);
  /// Writes out what is buffered.
  void close() { file_.close(); }
  /// Gives the closed file its name; without it, nothing is left.
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  std::string row_;
};

}  // namespace condyle::host
