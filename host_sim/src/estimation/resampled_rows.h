// SPDX-License-Identifier: Apache-2.0
// Estimates at a fixed rate, from those at the samples.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "estimation/estimate_row.h"

namespace condyle::host {

/// The recommended estimator's rows at the instants start + k / rate. Between two samples the
/// motion is that of white jerk with the states at both: position of degree 5, velocity of degree
/// 3, acceleration linear. Each variance is the larger of both samples' plus that of the motion in
/// between (the bridge of n-fold integrated white noise of density q over a step h, at the share u:
/// q h^(2n-1) (u (1-u))^(2n-1) / ((2n-1) ((n-1)!)^2)). Such values are at most derived. What
/// belongs to one sample (measurement, innovation) is not interpolated; identified values are those
/// of the earlier sample. No row lies within a gap of the times, or before a restart.
class ResampledRows {
 public:
  using Take = std::function<void(const EstimateRow&)>;

  explicit ResampledRows(double rate_Hz) : rate_Hz_(rate_Hz) {}

  /// Calls `take` for each instant after the row before, up to this one. A row has the events of
  /// all samples since the row taken before.
  void add(const EstimateRow& row, const Take& take);

 private:
  void give(EstimateRow row, const Take& take);

  double rate_Hz_;
  TimeNs start_ns_ = 0;
  std::int64_t next_ = 0;  // instant, counted from the start
  std::optional<EstimateRow> previous_;
  EventSet events_;  // of the samples since the row taken last
};

}  // namespace condyle::host
