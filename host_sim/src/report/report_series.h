// SPDX-License-Identifier: Apache-2.0
// Estimates over time for a report's charts, in bounded memory: runs of samples are reduced to
// their extremes and their widest interval, so that no peak is lost.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "estimation/estimate_row.h"

namespace condyle::host {

/// Collects the rows of a recording.
class ReportSeries {
 public:
  explicit ReportSeries(std::size_t most_runs) : most_runs_(most_runs) {}
  enum Chart { position, velocity, acceleration, friction, mass };
  static constexpr std::size_t kCharts = 5, kAxes = 3;

  /// A quantity over a run of samples, in SI units; NaN without a value.
  struct Curve {
    float low = kNone, high = kNone;  ///< extremes of the value
    float half = kNone;               ///< half of the widest 95 % interval
    bool is_assumed = false;          ///< one of the values at least
    void add(const Quantity<double>& quantity);
    void add(const Curve& other);
  };
  /// A run of consecutive samples.
  struct Run {
    double time_s = 0;  ///< of the first
    std::array<std::array<Curve, kAxes>, kCharts> curves;
  };

  void add(const EstimateRow& row);

  const std::vector<Run>& runs() const { return runs_; }
  /// 1 or 3; 0 without a row.
  int axis_count() const { return axis_count_; }
  /// The most frequent provenance of the chart's values; not_computed if it has none.
  Provenance provenance(Chart chart) const;
  /// Samples in each run but the last and those before a gap.
  std::uint64_t samples_per_run() const { return samples_per_run_; }
  /// Times of unusual samples (s), at most as many as runs.
  const std::vector<double>& event_times_s() const { return event_times_s_; }
  const EventCounts& events() const { return events_; }

 private:
  static constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  void add_to(Run& run, const EstimateRow& row);
  void begin_run(double time_s);
  void halve();

  std::size_t most_runs_;
  std::vector<Run> runs_;
  std::uint64_t samples_per_run_ = 1, samples_in_last_run_ = 0;
  int axis_count_ = 0;
  std::array<std::array<std::uint64_t, 4>, kCharts> provenances_{};  // counts
  std::vector<double> event_times_s_;
  EventCounts events_;
};

}  // namespace condyle::host
