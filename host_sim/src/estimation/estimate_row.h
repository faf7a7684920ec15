// SPDX-License-Identifier: Apache-2.0
// One row of estimates, from any estimator.
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/published/published_cascade.h"
#include "condyle/estimator/sample.h"
#include "condyle/estimator/sensors/driven_sensor.h"

namespace condyle::host {

/// The result of one sample. NaN and `not_computed` if there is no value.
struct EstimateRow {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::optional<TimeNs> time_ns;
  double measured_position_m = kNone;  ///< of the followed coordinate
  /// Of the followed point, x, y, z (or the one axis): its position as used; NaN without one.
  int point_axes = 1;
  std::array<double, 3> point_m = {kNone, kNone, kNone};
  Quantity<double> position_m, velocity_m_s, force_N, friction_Ns_m, mass_kg;
  double innovation_m = kNone;
  double motion_nis = kNone, friction_nis = kNone, mass_nis = kNone;
  EventSet events;
  Verdict verdict = Verdict::not_matched;  ///< published cascade only
  // Recommended estimator only:
  int axis_count = 0;             ///< 1 or 3
  AxisEstimate<double> followed;  ///< the axis whose values come first
  AxisEstimate<double> axes[3];   ///< all of them, x, y, z
  bool has_impedance = false;     ///< friction and mass are identified from a measured drive
  ImpedanceEstimate<double> impedance;
};

/// Number of axes with innovations in `row`: 3 or 1.
inline int innovation_axis_count(const EstimateRow& row) {
  return row.axis_count == 3 ? 3 : 1;
}

/// True if `row` repeats the measurement of the previous row.
bool is_duplicate(const EstimateRow& row);

/// Innovation along an axis over its predicted standard deviation (stage 1's of the published
/// cascade). NaN if there is none, or if it was rejected: it then carries no information on the
/// noise.
double standardised_innovation(const EstimateRow& row, int axis);

/// The published cascade's row for `sample`.
EstimateRow row_of(const Sample& sample, FollowedCoordinate followed,
                   const PublishedEstimate<double>& estimate);

/// The recommended estimator's row; `followed`: the axis whose values come first.
EstimateRow row_of(const RecommendedEstimate<double>& estimate, Axis followed);
/// The same with the result of the drive.
EstimateRow row_of(const DrivenEstimate<double>& estimate, Axis followed);

}  // namespace condyle::host
