// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "hosted/estimates/followed_cycles.h"
#include "output/output_file.h"

namespace condyle::host {

/// Cycles as CSV: one row for each, in SI units; the quantities are empty if it is not taken.
class CyclesFile {
 public:
  using Row = FoundCycle;

  explicit CyclesFile(const std::string& path);
  void write_row(const Row& row);
  bool has_reader() const { return file_.has_reader(); }
  /// As EstimatesFile.
  void close() { file_.close(); }
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
};

/// What a run's cycles show together.
class CyclesSummary {
 public:
  void add(const FoundCycle& cycle);
  /// How many are taken and not taken, and their mean duration.
  std::string text() const;
  /// The same as data.
  nlohmann::ordered_json json() const;

 private:
  // Of the durations (s), with two cycles or more.
  double mean_s() const { return sum_s_ / taken_; }
  double sd_s() const;

  int taken_ = 0, rejected_ = 0;
  double sum_s_ = 0, squares_s2_ = 0;
};

}  // namespace condyle::host
