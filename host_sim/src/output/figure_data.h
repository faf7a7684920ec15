// SPDX-License-Identifier: Apache-2.0
// Data of the figures of a replay, in bounded memory: long recordings are reduced to the extremes
// of equal runs of samples, so that no peak is lost.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "estimation/estimate_row.h"

namespace condyle::host {

/// The smallest and the largest number; NaN before the first.
struct Extremes {
  double lowest = std::numeric_limits<double>::quiet_NaN();
  double highest = std::numeric_limits<double>::quiet_NaN();
  /// Adds a number; ignores NaN.
  void add(double value) {
    if (!(lowest <= value)) lowest = std::isnan(value) ? lowest : value;
    if (!(highest >= value)) highest = std::isnan(value) ? highest : value;
  }
  void add(const Extremes& other) {
    add(other.lowest);
    add(other.highest);
  }
};

/// One estimated quantity over a run of samples.
struct FigureCurve {
  Extremes value;
  Extremes band;  ///< ends of the 95 % intervals
  /// The weakest in the run of samples.
  Provenance provenance = Provenance::measured;
};

/// A run of consecutive samples.
struct FigureRun {
  double time_s = 0;  ///< of the first sample, from FigureData::origin_ns
  Extremes measured_position_m;
  Extremes differentiated_velocity_m_s;
  FigureCurve position_m, velocity_m_s, force_N, friction_Ns_m, mass_kg;
  bool has_event = false;
};

/// Collects the rows of a replay.
class FigureData {
 public:
  static constexpr std::size_t kMostRuns = 4096;

  void add(const EstimateRow& row);
  const std::vector<FigureRun>& runs() const { return runs_; }
  /// Time of the first row that has one: the origin of the figures' time. Numbers relative to a
  /// distant origin, such as Unix time, would lose digits.
  TimeNs origin_ns() const { return origin_ns_.value_or(0); }
  /// Number of samples in each run except the last.
  std::uint64_t samples_per_run() const { return samples_per_run_; }

 private:
  std::vector<FigureRun> runs_;
  std::optional<TimeNs> origin_ns_;
  std::uint64_t samples_per_run_ = 1, samples_in_last_run_ = 0;
  struct Measured {
    TimeNs time_ns;
    double position_m;
  };
  std::optional<Measured> previous_;
};

}  // namespace condyle::host
