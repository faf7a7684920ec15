// SPDX-License-Identifier: Apache-2.0
// A recording of a relaxed jaw in a moving head, with the head's acceleration.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "condyle/estimator/impedance/head_motion.h"
#include "recordings/recording_choice.h"

namespace condyle::host {

/// The part of a recording, and the stated properties of its instruments.
struct HeadMotionSource {
  std::string recording;
  std::string acceleration;  ///< CSV with time_s and acceleration_m_s2; empty: a column of it
  RecordingChoice choice;
  std::optional<double> begin_s, end_s;  ///< from the recording's first time (s)
  double delay_s = 0;                    ///< delay of the acceleration's time stamps (s)
  std::optional<double> noise_sd_m, acceleration_noise_sd_m_s2;  ///< as stated; for comparison only
};

/// The values over time, one for each conclusion, for figures.
struct HeadMotionPoint {
  double time_s = 0;
  double damping_rate_per_s = 0, damping_rate_sd = 0;
  double stiffness_per_mass_per_s2 = 0, stiffness_sd = 0;
};

/// An identified head motion.
struct IdentifiedHeadMotion {
  std::string recording;
  std::vector<double> time_s, position_m;  ///< from the recording's first time
  std::vector<double> acceleration_time_s,
      acceleration_m_s2;  ///< likewise, corrected for the delay
  std::optional<double> stated_noise_sd_m, stated_acceleration_noise_sd_m_s2;
  HeadMotionParameters parameters;
  HeadMotionEstimate<double> estimate;
  std::vector<HeadMotionPoint> course;  ///< one for each second with an interval
  std::size_t taken = 0;                ///< positions with accelerations before and after them
  DriveCounts counts;
};

/// Reads and identifies it. Throws InputError if the recordings cannot be used.
IdentifiedHeadMotion identify_head_motion(const HeadMotionSource& source,
                                          const HeadMotionParameters& parameters);

}  // namespace condyle::host
