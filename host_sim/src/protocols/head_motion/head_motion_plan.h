// SPDX-License-Identifier: Apache-2.0
// The expected precision of a head motion, before it is recorded. One frequency w, steady state:
//
//   X, V      rms of position and velocity: the head's acceleration through the jaw's response
//   S         density of the residual: s_a^2 T + s_z^2 T |kappa - w^2 + i lambda w|^2, the
//             noise of acceleration and of positions, T their step
//   D         duration
//
// Noise:     S / (D V^2) for lambda, S / (D X^2) for kappa: the Cramer-Rao bound of a sinusoid's
//            amplitude in white noise
// Delay:     (kappa - w^2) sigma_t for lambda, lambda w^2 sigma_t for kappa
// Gain:      lambda sigma_g for lambda, (kappa - w^2) sigma_g for kappa; the lever's share likewise
// Muscles:   s rms(a) / V for lambda, s rms(a) / X for kappa
#pragma once

#include <optional>
#include <string>

#include "condyle/estimator/impedance/head_motion.h"

namespace condyle::host {

/// A planned head motion.
struct HeadMotionPlan {
  double rate_Hz = 60, noise_mm = 0.05, duration_s = 30;
  double acceleration_noise_sd_m_s2 = 0.05;
  double amplitude_mm = 10, frequency_Hz = 2;                   ///< of the head
  double damping_rate_per_s = 8, natural_frequency_Hz = 3.183;  ///< kv/m and omega expected
  HeadMotionParameters stated;  ///< of the accelerometer and of muscles
  std::optional<double> wanted_damping_rate_sd_per_s;
};

/// Standard deviations after a duration: from noise only, and with the stated uncertainties, which
/// do not average out.
struct HeadMotionDeviations {
  double duration_s = 0;
  double damping_rate_by_noise = 0, stiffness_by_noise = 0;
  double damping_rate_per_s = 0, stiffness_per_mass_per_s2 = 0;
};

/// The standard deviations of `plan` after `duration_s`.
HeadMotionDeviations expected_deviations(const HeadMotionPlan& plan, double duration_s);

/// The duration that reaches `sd_per_s` for kv/m; none if the stated uncertainties exceed it.
std::optional<double> duration_for(const HeadMotionPlan& plan, double sd_per_s);

/// The plan as text.
std::string plan_text(const HeadMotionPlan& plan);

}  // namespace condyle::host
