// SPDX-License-Identifier: Apache-2.0
// The smoothed path of the jaw over a whole recording.
#pragma once

#include <vector>

#include "readings/pose_noise.h"
#include "readings/pose_track.h"
#include "readings/reading_geometry.h"

namespace condyle::host {

struct WholePath {
  JawPath path;
  std::vector<double> incisor_sd_m;  ///< of each sample, mean of the three axes
  double largest_rotation_rad = 0;
  double largest_displacement_m = 0;  ///< of the middle of the instrument's points
};

/// The path of `motion`, whose samples have the covariance `noise` (m, rad). Parts are smoothed on
/// all cores; the result does not depend on their number.
WholePath whole_path(const ReferredMotion& motion, const ReadingGeometry& geometry,
                     const Matrix6& noise);

}  // namespace condyle::host
