// SPDX-License-Identifier: Apache-2.0
// Smoothness of a movement from its speed.
//
//   SPARC   -sum sqrt((df / (f_last - f_first))^2 + dV^2), V the amplitude spectrum over its
//   largest
//           value, from the first to the last frequency up to 10 Hz with V >= 0.05; zero padding
//           to 16 times the next power of two
//   LDLJ    -ln (T^3 / v_peak^2 sum (d^2 v / dt^2)^2 dt), T = N dt
// Balasubramanian, Melendez-Calderon, Roby-Brami, Burdet 2015, J NeuroEng Rehabil 12:112.
#pragma once

#include <vector>

namespace condyle::host {

/// Spectral arc length of `speed`, sampled every `step_s`; NaN if there is none.
double spectral_arc_length(const std::vector<double>& speed, double step_s);

/// Log dimensionless jerk of `speed`; NaN if there is none.
double log_dimensionless_jerk(const std::vector<double>& speed, double step_s);

}  // namespace condyle::host
