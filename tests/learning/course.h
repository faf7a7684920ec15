// SPDX-License-Identifier: Apache-2.0
// Simulated motion along one axis with its true velocity and acceleration, and how far the
// recommended estimator is from them with and without learning.
#pragma once

#include <string>
#include <vector>

#include "condyle/estimator/sample.h"

namespace condyle::testing_support {

/// Samples, and the truth of each.
struct Course {
  double rate_Hz = 60;
  std::vector<Sample> samples;
  std::vector<double> velocity_m_s, acceleration_m_s2;

  void add(double time_s, double measured_m, double velocity, double acceleration);
};

/// What a subject does, and what sees it.
struct CourseSettings {
  std::string scenario;  ///< a file of host_sim/scenarios, without .toml
  double rate_Hz = 60, noise_m = 1e-4, duration_s = 60;
  bool is_regular = false;  ///< 3 % spread of the rate, 5 % of the height, no pauses
  double jitter_s = 0, smoothing = 0, quantum_m = 0, lost_share = 0, glitch_share = 0;
  bool has_faults = false;  ///< zeros for 0.5 s from 20 s on, frozen for 0.5 s from 40 s on
  double tremor_m = -1;     ///< of the scenario if below 0
};

/// Simulates a subject. Throws host::InputError if the scenario does not exist.
Course simulate_course(const CourseSettings& settings, std::uint64_t seed);

/// One of the files of consistency/vectors.
Course read_course(const std::string& name);

/// Errors from `from_s` to `to_s`.
struct CourseScore {
  double velocity_error_m_s = 0, acceleration_error_m_s2 = 0;  ///< rms
  double velocity_held = 0, acceleration_held = 0;             ///< share of 95 % intervals
  double corrected = 0;                                        ///< share of samples
  std::size_t samples = 0;
};

/// Stretches of a course (s).
struct CourseStretch {
  double from_s = 12, to_s = 1e9;
};

/// Of the estimator with `kernels` kernels, `lag` samples late; one score for each stretch.
/// `Scalar`: float or double.
template <class Scalar>
std::vector<CourseScore> score_course(const Course& course, int kernels, int lag,
                                      const std::vector<CourseStretch>& stretches);

}  // namespace condyle::testing_support
