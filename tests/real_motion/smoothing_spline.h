// SPDX-License-Identifier: Apache-2.0
// Smoothing of even samples, looked at as a whole.
#pragma once

#include <vector>

namespace condyle::testing_support {

/// Minimises sum (y - x)^2 + lambda sum (third difference of x)^2.
std::vector<double> smooth(const std::vector<double>& y, double lambda);

/// Derivative at the samples of the quintic spline through `x` (8 or more, `T` apart), its fifth
/// derivative continuous at the two knots next to each end.
std::vector<double> spline_derivative(const std::vector<double>& x, double T);

/// Runs a second-order Butterworth low-pass over `x` (10 or more) forwards, then backwards;
/// `cutoff` is a share of the sampling frequency. The ends go on mirrored in a point.
std::vector<double> butterworth(const std::vector<double>& x, double cutoff);

/// Velocity of a stretch of a recording.
struct SplineVelocity {
  double noise = 0;  ///< standard deviation of a sample
  std::vector<double> velocity, velocity_sd;
};

/// The smoothing spline whose lambda generalised cross-validation chooses (P. Craven, G. Wahba,
/// Numer. Math. 31 (1979) 377) among those that pass 1 Hz. The variance of its velocity is that of
/// the noise and what lambda times and divided by 8, and a Butterworth filter at 0.9 of the
/// spline's cut-off, change in it: half of each, squared, mean of nine samples.
SplineVelocity fit_smoothing_spline(const std::vector<double>& y, double T);

}  // namespace condyle::testing_support
