// SPDX-License-Identifier: Apache-2.0
// Converts a target's estimates to double.
#pragma once

#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/motion/recommended_estimator.h"
#include "condyle/estimator/published/published_cascade.h"

namespace condyle::host {

template <class Scalar>
Quantity<double> to_double(const Quantity<Scalar>& quantity) {
  return {static_cast<double>(quantity.value), static_cast<double>(quantity.standard_deviation),
          quantity.provenance};
}

template <class Scalar>
PublishedEstimate<double> to_double(const PublishedEstimate<Scalar>& estimate) {
  PublishedEstimate<double> wide;
  wide.position_m = to_double(estimate.position_m);
  wide.velocity_m_s = to_double(estimate.velocity_m_s);
  wide.force_N = to_double(estimate.force_N);
  wide.friction_Ns_m = to_double(estimate.friction_Ns_m);
  wide.mass_kg = to_double(estimate.mass_kg);
  wide.innovation_m = static_cast<double>(estimate.innovation_m);
  wide.motion_nis = static_cast<double>(estimate.motion_nis);
  wide.friction_nis = static_cast<double>(estimate.friction_nis);
  wide.mass_nis = static_cast<double>(estimate.mass_nis);
  wide.events = estimate.events;
  wide.verdict = estimate.verdict;
  return wide;
}

template <class Scalar>
RecommendedEstimate<double> to_double(const RecommendedEstimate<Scalar>& estimate) {
  RecommendedEstimate<double> wide;
  wide.is_ready = estimate.is_ready;
  wide.time_ns = estimate.time_ns;
  wide.time_valid = estimate.time_valid;
  wide.axis_count = estimate.axis_count;
  wide.nis = static_cast<double>(estimate.nis);
  wide.events = estimate.events;
  for (int i = 0; i < estimate.axis_count; ++i) {
    const AxisEstimate<Scalar>& axis = estimate.axes[i];
    wide.axes[i] = {.position_m = to_double(axis.position_m),
                    .velocity_m_s = to_double(axis.velocity_m_s),
                    .acceleration_m_s2 = to_double(axis.acceleration_m_s2),
                    .force_N = to_double(axis.force_N),
                    .measured_position_m = static_cast<double>(axis.measured_position_m),
                    .innovation_m = static_cast<double>(axis.innovation_m),
                    .innovation_sd_m = static_cast<double>(axis.innovation_sd_m),
                    .noise_sd_m = static_cast<double>(axis.noise_sd_m),
                    .jerk_density_m2_s5 = static_cast<double>(axis.jerk_density_m2_s5),
                    .velocity_learned = static_cast<double>(axis.velocity_learned),
                    .acceleration_learned = static_cast<double>(axis.acceleration_learned)};
  }
  return wide;
}

template <class Scalar>
IdentifiedValue<double> to_double(const IdentifiedValue<Scalar>& value) {
  IdentifiedValue<double> wide;
  wide.quantity = to_double(value.quantity);
  wide.fitted = static_cast<double>(value.fitted);
  wide.fitted_sd = static_cast<double>(value.fitted_sd);
  wide.sampling_sd = static_cast<double>(value.sampling_sd);
  wide.needed_s = static_cast<double>(value.needed_s);
  wide.limit = value.limit;
  return wide;
}

template <class Scalar>
ImpedanceEstimate<double> to_double(const ImpedanceEstimate<Scalar>& impedance) {
  ImpedanceEstimate<double> wide;
  wide.friction_Ns_m = to_double(impedance.friction_Ns_m);
  wide.mass_kg = to_double(impedance.mass_kg);
  wide.stiffness_N_m = to_double(impedance.stiffness_N_m);
  wide.offset_N = to_double(impedance.offset_N);
  wide.coulomb_N = to_double(impedance.coulomb_N);
  wide.delay_s = to_double(impedance.delay_s);
  wide.plain = {static_cast<double>(impedance.plain.friction_Ns_m),
                static_cast<double>(impedance.plain.mass_kg),
                static_cast<double>(impedance.plain.stiffness_N_m),
                static_cast<double>(impedance.plain.offset_N),
                static_cast<double>(impedance.plain.delay_s)};
  wide.used_s = static_cast<double>(impedance.used_s);
  wide.drive_noise_sd_N = static_cast<double>(impedance.drive_noise_sd_N);
  wide.position_noise_sd_m = static_cast<double>(impedance.position_noise_sd_m);
  wide.drive_rms_N = static_cast<double>(impedance.drive_rms_N);
  wide.drive_variation_rms_N = static_cast<double>(impedance.drive_variation_rms_N);
  wide.velocity_rms_m_s = static_cast<double>(impedance.velocity_rms_m_s);
  wide.position_rms_m = static_cast<double>(impedance.position_rms_m);
  wide.residual_ratio = static_cast<double>(impedance.residual_ratio);
  return wide;
}

}  // namespace condyle::host
