// SPDX-License-Identifier: Apache-2.0
// Smoothness of a movement from its speed.
//
//   SPARC   -sum sqrt((df / (f_last - f_first))^2 + dV^2), V the amplitude spectrum over its
//   largest
//           value, from the first to the last frequency up to 10 Hz with V >= 0.05; zero padding
//           to 16 times the next power of two
//   LDLJ    -ln (T^3 / v_peak^2 sum (d^2 v / dt^2)^2 dt), T = N dt
// A movement between samples: the speed at the middles of N equal parts, so that its first and last
// instants need not be samples. Without extrapolation the sum of LDLJ lacks two parts, where the
// jerk of a movement is greatest.
// Where the spectrum has a lobe near the threshold, a little noise decides whether it counts. At
// the zeros between lobes the chords between bins are shorter than the arc: of a movement with a
// stop, the same at 200 and 2,000 Hz differs by 0.05. Of noise that neighbouring samples share
// (shared_noise.h) the spectrum is known roughly: of a tremor it may be a lobe. With such noise an
// arc length is hidden if its half interval exceeds a lobe's height. Balasubramanian,
// Melendez-Calderon, Roby-Brami, Burdet 2015, J NeuroEng Rehabil 12:112.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "readings/reading.h"
#include "readings/shared_noise.h"

namespace condyle::host {

/// Spectral arc length of `speed`, sampled every `step_s`; NaN if there is none.
double spectral_arc_length(const std::vector<double>& speed, double step_s);

/// Second derivatives at the first and last sample.
enum class EndJerk { left_out, extrapolated };

/// Log dimensionless jerk of `speed`; NaN if there is none.
double log_dimensionless_jerk(const std::vector<double>& speed, double step_s,
                              EndJerk ends = EndJerk::left_out);

struct Smoothness {
  double spectral_arc_length;
  /// What a threshold lower or higher by 10 % changes, and bins elsewhere.
  double arc_length_doubt;
  double log_dimensionless_jerk;
};

/// Those of the movement from `from_s` to `to_s` with the rising times `time_s`.
Smoothness smoothness_of(const std::vector<double>& time_s, const std::vector<double>& speed,
                         double from_s, double to_s);

/// Doubts about the arc lengths of the ways out and back, which are the last two of `values`, and
/// are removed.
std::array<double, 2> take_arc_length_doubts(std::vector<UncertainValue>& values);

/// Adds to a reading called `name` what its definition leaves open: these doubts, or how much LDLJ
/// changes with the number of samples. Hides an arc length on which `noise` that neighbours share
/// may decide.
void widen_smoothness(std::string_view name, const std::array<double, 2>& doubts,
                      const std::vector<SharedNoise>& noise, UncertainValue& value);

}  // namespace condyle::host
