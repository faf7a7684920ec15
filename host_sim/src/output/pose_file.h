// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "condyle/estimator/pose/pose_estimate.h"
#include "hosted/estimates/pose_choice.h"
#include "output/output_file.h"

namespace condyle::host {

/// Estimates of the whole pose as CSV: one row for each sample, in SI units, with all digits; a
/// field is empty if the value was not computed.
class PoseFile {
 public:
  using Row = PoseEstimate<double>;

  PoseFile(const std::string& path, const PoseChoice& choice);
  void write_row(const Row& row);
  bool has_reader() const { return file_.has_reader(); }
  /// As EstimatesFile.
  void close() { file_.close(); }
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  PoseChoice choice_;
  std::string row_;
};

/// What a run's pose estimates show together.
class PoseSummary {
 public:
  void add(const PoseEstimate<double>& estimate);
  /// How many samples have a pose, the largest turn, and the mean NIS.
  std::string text() const;
  /// Why the intervals cannot be relied on, or why there is no pose.
  std::vector<std::string> warnings() const;

 private:
  double mean_nis() const {
    return judged_ > 0 ? nis_sum_ / static_cast<double>(judged_)
                       : std::numeric_limits<double>::quiet_NaN();
  }

  std::uint64_t samples_ = 0, known_ = 0, judged_ = 0;
  double largest_turn_rad_ = 0, nis_sum_ = 0;
};

}  // namespace condyle::host
