// SPDX-License-Identifier: Apache-2.0
// Recordings whose numbers have few digits.
//
//   q    step: all differences between successive coordinates are multiples of it
//   C    covariance of the pose if each coordinate is off by an error that is uniform within q
// While the jaw rests with less noise than a step, each coordinate stays on one number: the mean of
// the rest is off by up to half a step, however long it is. Of noise with the standard deviation s
// exp(-4 pi^2 s^2 / q^2) of C is left (Widrow, Kollar 2008, Quantization Noise, chapter 19).
#pragma once

#include <algorithm>
#include <vector>

#include "readings/pose_noise.h"

namespace condyle::host {

/// The largest step of which all differences between successive `numbers` are multiples, up to 1 %
/// of it; 0 if there is none, as of numbers with many digits.
double step_of(const std::vector<double>& numbers);

/// The largest step that the coordinates of `points` points have in so many `samples`; 0 if one has
/// none. `points_at(k)`: those of sample k, one a column (m).
template <class PointsAt>
double step_of_points(std::size_t samples, Eigen::Index points, const PointsAt& points_at) {
  double step_m = 0;
  std::vector<double> numbers(samples);
  for (Eigen::Index i = 0; i < 3 * points; ++i) {
    for (std::size_t k = 0; k < samples; ++k) numbers[k] = points_at(k)(i % 3, i / 3);
    const double of_one_m = step_of(numbers);
    if (of_one_m == 0) return 0;
    step_m = std::max(step_m, of_one_m);
  }
  return step_m;
}

/// The covariance C of the pose of `track` at sample `at`; 0 if its points show no step.
Matrix6 covariance_of_steps(const PoseTrack& track, std::size_t at);

/// What is left of `steps`, a C, in the mean of many samples with this noise, C included.
Matrix6 left_in_mean(const Matrix6& steps, const PoseNoise& noise);

}  // namespace condyle::host
