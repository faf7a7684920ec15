// SPDX-License-Identifier: Apache-2.0
// What measures of a path are worth: values with the parts of their uncertainty.
//
//   y    samples of the stroke; S smoothing; F(S y) the measures; e noise of the samples, and how
//        far the motion goes while their times are off
//   z    the motion smoothed over a wider window, with hardly any noise
//   m    the motion smoothed over a still wider window, then averaged over half of it
//   smoothing   F(S z) - F(z), what smoothing changes, is subtracted, and a multiple of it is in
//               the interval
//   S'   smoothing over 20 ms on both sides, at least five samples
//   narrowing   F(S' y) - F(S y), minus the same of z and of noise: where the movement is more
//               abrupt than z. A multiple of what exceeds its noise is in the interval
//   abrupt parts   (abrupt_parts.h) like narrowing, with S' only where it differs from S by more
//               than noise, so that no noise is subtracted. The noise of the whole path would hide
//               a short movement. The larger of both counts
//   noise       mean of F(S(m + e)) - F(S m), what noise adds, is subtracted, and its size is in
//               the interval; the standard deviation of these is that of the value
//   fixed       F with one landmark coordinate, or one component of the reference position, off by
//               its standard deviation: an error that all strokes of a recording share
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "readings/pose_noise.h"
#include "readings/reading.h"
#include "readings/reading_geometry.h"
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

/// How to find the uncertainty.
struct DrawSettings {
  int pairs;                      ///< of draws of noise
  double calm_half_s;             ///< half window of z
  double mild_half_s;             ///< half window of m
  PathPart part = PathPart::all;  ///< what `read` needs
  double times_smoothing = 2;     ///< of what smoothing changed: what the interval contains
};

/// The values that `read` gives for the samples `begin` to `end` (without) of `motion`.
std::vector<UncertainValue> uncertain_values(const ReferredMotion& motion, std::size_t begin,
                                             std::size_t end, const PoseNoise& noise,
                                             const SharedErrors& errors, DrawSettings settings,
                                             RandomGenerator& random, const ReadPath& read);

/// The samples of `run` that can decide how far `path`, which is that of `motion`, and its rotation
/// reach: those that lie within six standard deviations of a sample's noise of the greatest, and
/// all less than 0.6 s from them, farther than smoothing reaches. For long recordings.
ReferredMotion near_greatest_of(const JawPath& path, const ReferredMotion& motion,
                                const PoseNoise& noise, SampleRun run);

}  // namespace condyle::host
