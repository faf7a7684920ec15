// SPDX-License-Identifier: Apache-2.0
// An estimate as bytes: every field, the same on every machine.
#pragma once

#include "byte_stream.h"
#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/pose/pose_estimate.h"
#include "condyle/estimator/published/published_cascade.h"

namespace condyle::cross {

/// Serialises estimates, field after field, to `out`, which takes bytes with `put`.
template <class Sink>
struct EstimateWriter {
  Sink& out;

  template <class Number>
  void operator()(Number value) {
    put_number(value, [this](std::uint8_t byte) { out.put(byte); });
  }
  template <class Scalar>
  void operator()(const Quantity<Scalar>& quantity) {
    (*this)(quantity.value);
    (*this)(quantity.standard_deviation);
    (*this)(static_cast<std::uint8_t>(quantity.provenance));
  }
  void operator()(EventSet events) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kEventCount; ++i) {
      if (events.has(static_cast<Event>(i))) bits |= std::uint32_t{1} << i;
    }
    (*this)(bits);
  }
  template <class Scalar>
  void operator()(const PublishedEstimate<Scalar>& estimate) {
    for (const auto* quantity : {&estimate.position_m, &estimate.velocity_m_s, &estimate.force_N,
                                 &estimate.friction_Ns_m, &estimate.mass_kg}) {
      (*this)(*quantity);
    }
    for (const Scalar value :
         {estimate.innovation_m, estimate.motion_nis, estimate.friction_nis, estimate.mass_nis}) {
      (*this)(value);
    }
    (*this)(estimate.events);
    (*this)(static_cast<std::uint8_t>(estimate.verdict));
  }
  template <class Scalar>
  void operator()(const RecommendedEstimate<Scalar>& estimate) {
    (*this)(static_cast<std::uint8_t>(estimate.is_ready));
    (*this)(static_cast<std::uint64_t>(estimate.time_ns));
    (*this)(static_cast<std::uint8_t>(estimate.time_valid));
    (*this)(static_cast<std::uint8_t>(estimate.axis_count));
    for (int axis = 0; axis < estimate.axis_count; ++axis) {
      const AxisEstimate<Scalar>& one = estimate.axes[axis];
      for (const auto* quantity :
           {&one.position_m, &one.velocity_m_s, &one.acceleration_m_s2, &one.force_N}) {
        (*this)(*quantity);
      }
      for (const Scalar value : {one.measured_position_m, one.innovation_m, one.innovation_sd_m,
                                 one.noise_sd_m, one.jerk_density_m2_s5}) {
        (*this)(value);
      }
    }
    (*this)(estimate.nis);
    (*this)(estimate.events);
  }
  template <class Scalar>
  void operator()(const VectorEstimate<Scalar>& estimate) {
    for (const Scalar value : estimate.value.reshaped()) (*this)(value);
    for (const Scalar value : estimate.covariance.reshaped()) (*this)(value);
    (*this)(static_cast<std::uint8_t>(estimate.provenance));
  }
  template <class Scalar>
  void operator()(const PoseEstimate<Scalar>& estimate) {
    (*this)(static_cast<std::uint8_t>(estimate.is_ready));
    (*this)(static_cast<std::uint64_t>(estimate.time_ns));
    (*this)(static_cast<std::uint8_t>(estimate.time_valid));
    const auto point = estimate.point({Scalar(0.05), Scalar(0.03), Scalar(0.09)});
    for (const auto* vector :
         {&estimate.centre_m, &estimate.centre_velocity_m_s, &estimate.rotation_vector_rad,
          &estimate.angular_velocity_rad_s, &point.position_m, &point.velocity_m_s}) {
      (*this)(*vector);
    }
    const auto turn = estimate.turn_about({Scalar(0.6), Scalar(0.8), 0});
    for (const auto* quantity : {&turn.twist_rad, &turn.twist_rate_rad_s, &turn.swing_rad}) {
      (*this)(*quantity);
    }
    (*this)(estimate.nis);
    (*this)(estimate.events);
  }
};

}  // namespace condyle::cross
