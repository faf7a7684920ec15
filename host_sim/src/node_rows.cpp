// SPDX-License-Identifier: Apache-2.0
#include "node_rows.h"

namespace condyle::host {
namespace {

template <class Scalar>
Quantity<double> widened(const Quantity<Scalar>& quantity) {
  return {static_cast<double>(quantity.value), static_cast<double>(quantity.standard_deviation),
          quantity.provenance};
}

template <class Scalar>
PublishedEstimate<double> widened(const PublishedEstimate<Scalar>& estimate) {
  PublishedEstimate<double> wide;
  wide.position_m = widened(estimate.position_m);
  wide.velocity_m_s = widened(estimate.velocity_m_s);
  wide.force_N = widened(estimate.force_N);
  wide.friction_Ns_m = widened(estimate.friction_Ns_m);
  wide.mass_kg = widened(estimate.mass_kg);
  wide.innovation_m = static_cast<double>(estimate.innovation_m);
  wide.motion_nis = static_cast<double>(estimate.motion_nis);
  wide.friction_nis = static_cast<double>(estimate.friction_nis);
  wide.mass_nis = static_cast<double>(estimate.mass_nis);
  wide.events = estimate.events;
  wide.verdict = estimate.verdict;
  return wide;
}

template <class Scalar>
RecommendedEstimate<double> widened(const RecommendedEstimate<Scalar>& estimate) {
  RecommendedEstimate<double> wide;
  wide.is_ready = estimate.is_ready;
  wide.time_ns = estimate.time_ns;
  wide.time_valid = estimate.time_valid;
  wide.axis_count = estimate.axis_count;
  wide.nis = static_cast<double>(estimate.nis);
  wide.events = estimate.events;
  for (int i = 0; i < estimate.axis_count; ++i) {
    const AxisEstimate<Scalar>& axis = estimate.axes[i];
    wide.axes[i] = {.position_m = widened(axis.position_m),
                    .velocity_m_s = widened(axis.velocity_m_s),
                    .acceleration_m_s2 = widened(axis.acceleration_m_s2),
                    .force_N = widened(axis.force_N),
                    .measured_position_m = static_cast<double>(axis.measured_position_m),
                    .innovation_m = static_cast<double>(axis.innovation_m),
                    .innovation_sd_m = static_cast<double>(axis.innovation_sd_m),
                    .noise_sd_m = static_cast<double>(axis.noise_sd_m),
                    .jerk_density_m2_s5 = static_cast<double>(axis.jerk_density_m2_s5)};
  }
  return wide;
}

}  // namespace

template <class Scalar>
std::optional<EstimateRow> NodeRows::row_in(const hal::LinkFrame& frame) {
  const auto is_read = [&](auto& message) {
    return frame.type == static_cast<std::uint8_t>(message.kType) &&
           hal::get(frame.payload, message).reason == hal::RefusalReason::none;
  };
  if (axis_count_ == 0) {
    hal::PublishedEstimateMessage<Scalar> message;
    if (is_read(message)) {
      Sample sample;
      sample.time_ns = message.sample.time_ns;
      sample.time_valid = message.sample.time_valid;
      sample.position_valid = false;
      return host::row_of(sample, followed_, widened(message.estimate));
    }
  } else {
    hal::RecommendedEstimateMessage<Scalar> message;
    if (is_read(message) &&
        (message.estimate.axis_count == axis_count_ || !message.estimate.is_ready)) {
      if (!message.estimate.is_ready) return std::nullopt;
      return host::row_of(widened(message.estimate), followed_.axis);
    }
  }
  ++unreadable_;
  return std::nullopt;
}

std::optional<EstimateRow> NodeRows::row_of(const hal::LinkFrame& frame) {
  return scalar_size_ == sizeof(float) ? row_in<float>(frame) : row_in<double>(frame);
}

}  // namespace condyle::host
