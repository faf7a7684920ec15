// SPDX-License-Identifier: Apache-2.0
// What a head motion can be expected to tell, before it is recorded.
#pragma once

#include <optional>
#include <string>

#include "condyle/estimator/head_motion.h"

namespace condyle::host {

/// A planned head motion.
struct HeadMotionPlan {
  double rate_Hz = 60, noise_mm = 0.05, duration_s = 30;
  double amplitude_mm = 10, frequency_Hz = 2;  ///< of the head; one frequency, from standstill
  double damping_rate_per_s = 8, natural_frequency_Hz = 3.183;  ///< kv/m and omega expected
  HeadMotionParameters stated;  ///< of the accelerometer and of muscles
  std::optional<double> wanted_damping_rate_sd_per_s;
};

/// Standard deviations after a duration: by the filter's covariance along the motion itself, and
/// with what is stated of delay and muscles, which no duration averages out.
struct HeadMotionDeviations {
  double duration_s = 0;
  double damping_rate_by_filter = 0, stiffness_by_filter = 0;
  double damping_rate_per_s = 0, stiffness_per_mass_per_s2 = 0;
};

/// Those of `plan` after `duration_s`.
HeadMotionDeviations expected_deviations(const HeadMotionPlan& plan, double duration_s);

/// Shortest duration of at most 900 s that reaches `sd_per_s` for kv/m, to 0.1 s.
std::optional<double> duration_for(const HeadMotionPlan& plan, double sd_per_s);

/// All of it in words.
std::string plan_text(const HeadMotionPlan& plan);

}  // namespace condyle::host
