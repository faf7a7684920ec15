// SPDX-License-Identifier: Apache-2.0
#include "estimation/estimate_row.h"

#include <algorithm>
#include <cmath>

namespace condyle::host {

bool is_duplicate(const EstimateRow& row) {
  return row.events.has(Event::time_repeated) && !std::isfinite(row.measured_position_m);
}

double standardised_innovation(const EstimateRow& row, int axis) {
  if (is_unexpected(row.events)) return EstimateRow::kNone;
  if (row.axis_count == 0) return std::copysign(std::sqrt(row.motion_nis), row.innovation_m);
  return row.axes[axis].innovation_m / row.axes[axis].innovation_sd_m;
}

EstimateRow row_of(const Sample& sample, FollowedCoordinate followed,
                   const PublishedEstimate<double>& estimate) {
  EstimateRow row;
  if (sample.time_valid) row.time_ns = sample.time_ns;
  row.point_axes = sample.kind == SampleKind::one_axis ? 1 : 3;
  if (sample.position_valid && !estimate.events.has(Event::zero_filled) &&
      is_available(sample.kind, followed)) {
    row.measured_position_m = followed_position_m(sample, followed);
    row.point_m[0] = row.measured_position_m;
    for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
      if (sample.kind == SampleKind::one_axis) break;
      row.point_m[static_cast<std::size_t>(axis)] =
          followed_position_m(sample, {followed.point, axis});
    }
  }
  row.position_m = estimate.position_m;
  row.velocity_m_s = estimate.velocity_m_s;
  row.force_N = estimate.force_N;
  row.friction_Ns_m = estimate.friction_Ns_m;
  row.mass_kg = estimate.mass_kg;
  row.innovation_m = estimate.innovation_m;
  row.motion_nis = estimate.motion_nis;
  row.friction_nis = estimate.friction_nis;
  row.mass_nis = estimate.mass_nis;
  row.events = estimate.events;
  row.verdict = estimate.verdict;
  return row;
}

EstimateRow row_of(const RecommendedEstimate<double>& estimate, Axis followed) {
  EstimateRow row;
  if (estimate.time_valid) row.time_ns = estimate.time_ns;
  row.axis_count = row.point_axes = estimate.axis_count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(estimate.axis_count); ++i) {
    row.point_m[i] = estimate.axes[i].measured_position_m;
  }
  std::copy(std::begin(estimate.axes), std::end(estimate.axes), std::begin(row.axes));
  const AxisEstimate<double>& axis = row.followed =
      estimate.axes[estimate.axis_count == 3 ? static_cast<int>(followed) : 0];
  row.measured_position_m = axis.measured_position_m;
  row.position_m = axis.position_m;
  row.velocity_m_s = axis.velocity_m_s;
  row.force_N = axis.force_N;
  row.innovation_m = axis.innovation_m;
  const double standardised = axis.innovation_m / axis.innovation_sd_m;
  row.motion_nis = standardised * standardised;
  row.events = estimate.events;
  return row;
}

EstimateRow row_of(const DrivenEstimate<double>& estimate, Axis followed) {
  const RecommendedEstimate<double>& motion = estimate;
  EstimateRow row = row_of(motion, followed);
  row.has_impedance = true;
  row.impedance = estimate.impedance;
  row.friction_Ns_m = estimate.impedance.friction_Ns_m.quantity;
  row.mass_kg = estimate.impedance.mass_kg.quantity;
  return row;
}

}  // namespace condyle::host
