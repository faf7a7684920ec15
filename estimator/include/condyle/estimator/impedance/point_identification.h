// SPDX-License-Identifier: Apache-2.0
// Friction and mass of a point from a measured drive: runs the regression and concludes once a
// second of the recording.
#pragma once

#include "condyle/estimator/impedance/point_conclusion.h"

namespace condyle {

/// Turns drive and positions, each with its own times and rate, into a conclusion. Fixed size, no
/// allocation.
template <class Scalar>
class PointIdentification {
 public:
  /// `parameters` must be valid.
  explicit PointIdentification(const ImpedanceParameters& parameters)
      : parameters_(parameters), regression_(parameters) {
    conclude();
  }

  /// A measured drive (N), stamped `time_ns`, in order. No position may be later than the next
  /// drive by more than their ring holds (point_regression.h).
  void add_drive(TimeNs time_ns, Scalar drive_N) { regression_.add_drive(time_ns, drive_N); }

  /// A measured position (m). Missing and rejected ones are left out.
  void add_position(TimeNs time_ns, Scalar position_m) {
    regression_.add_position(time_ns, position_m);
    TimeNs since_ns = 0;
    const bool is_due = !has_concluded_ ||
                        __builtin_sub_overflow(time_ns, concluded_ns_, &since_ns) ||
                        since_ns >= kNanosecondsPerSecond || since_ns < 0;
    if (!is_due) return;
    concluded_ns_ = time_ns;
    has_concluded_ = true;
    conclude();
  }

  /// Concludes now, from everything given so far.
  void conclude() {
    estimate_ = PointConclusion<Scalar>(regression_, parameters_).draw();
    ++conclusions_;
  }

  /// The last conclusion.
  const ImpedanceEstimate<Scalar>& estimate() const { return estimate_; }
  /// Number of conclusions.
  std::uint64_t conclusions() const { return conclusions_; }
  DriveCounts counts() const { return regression_.counts(); }

 private:
  ImpedanceParameters parameters_;
  PointRegression<Scalar> regression_;
  ImpedanceEstimate<Scalar> estimate_;
  std::uint64_t conclusions_ = 0;
  bool has_concluded_ = false;
  TimeNs concluded_ns_ = 0;
};

}  // namespace condyle
