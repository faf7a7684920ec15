// SPDX-License-Identifier: Apache-2.0
// What measures of a path are worth: values with the parts of their uncertainty.
//
//   y    smoothed motion of the stroke; F(y) the measures; S smoothing; e noise of the samples
//   smoothing   F(S y) - F(y), what smoothing once more changes, is the estimate of what it changed
//               the first time. As far as it exceeds noise it is subtracted, and the interval
//               contains twice of it
//   noise       mean of F(S(y + e)) and F(S(y - e)) minus F(S y): what noise adds on average, which
//               is subtracted; half the difference: its standard deviation
//   fixed       F with one landmark coordinate, or one component of the reference position, off by
//               its standard deviation: an error that all strokes of a recording share
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "readings/reading_geometry.h"
#include "readings/pose_noise.h"
#include "readings/reading.h"
#include "statistics/random.h"

namespace condyle::host {

/// The geometry, and the same with each shared error in turn.
struct SharedErrors {
  ReadingGeometry geometry;
  std::vector<ReadingGeometry> off_by_one_sd;
};

/// Those of `landmarks` (null: none) and of a reference position with the covariance `reference`.
SharedErrors shared_errors(const Landmarks* landmarks, const ReadingGeometry& geometry,
                           const Matrix6& reference);

/// Fills `values` from a path; `why`, if not null, with the reasons for what is missing.
using ReadPath = std::function<void(const JawPath& path, std::vector<double>& values,
                                    std::vector<std::string>* why)>;

/// The values that `read` gives for the samples `begin` to `end` (without) of `motion`, with
/// `pairs` pairs of draws of `noise`.
std::vector<UncertainValue> uncertain_values(const ReferredMotion& motion, std::size_t begin,
                                             std::size_t end, const PoseNoise& noise,
                                             const SharedErrors& errors, int pairs,
                                             RandomGenerator& random, const ReadPath& read);

/// The smoothed motion of those samples.
SmoothMotion smooth_motion(const ReferredMotion& motion, std::size_t begin, std::size_t end);

}  // namespace condyle::host
