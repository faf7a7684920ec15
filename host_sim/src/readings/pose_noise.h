// SPDX-License-Identifier: Apache-2.0
// The noise of a recording's poses, from the recording itself.
//
//   d    sixth divided difference of neighbouring samples, weights w with sum w^2 = 1: it cancels
//        the motion; median of its size -> variance, share of equal signs -> correlation
//        (sin(pi/2 q), Greiner's relation)
//   times that are off by tau (sd) displace a sample along its path: var d = variance + tau^2 v^2.
//   tau follows from d where the jaw is fast and where it is slow, if they differ beyond chance
//   smoothed recordings: noise that neighbours share vanishes in these differences. At rest,
//   differences over longer steps show it; the covariance grows by the largest ratio, as far as it
//   is beyond chance. Draws are then of noise with the correlation that the rest shows
//   (shared_noise.h).
#pragma once

#include <cmath>

#include "readings/pose_track.h"
#include "readings/shared_noise.h"

namespace condyle::host {

/// Noise of one sample's motion.
struct PoseNoise {
  Matrix6 covariance = Matrix6::Zero();     ///< m^2, m rad, rad^2
  Matrix6 root = Matrix6::Zero();           ///< root root' = covariance
  double coloured = 1;                      ///< variance of what averages slowly, over that above
  bool is_known = false;                    ///< enough samples are near to others
  bool is_checked_at_rest = false;          ///< the rest was long enough to see colour
  double stamp_sd_s = 0;                    ///< of the times; 0: no more than noise explains
  std::vector<SharedNoise> shared;          ///< what neighbours share; empty: nothing beyond chance
  Matrix6 beside_shared = Matrix6::Zero();  ///< root of the covariance of the rest of the noise

  /// Root of the covariance of what neighbours do not share.
  const Matrix6& white_root() const { return shared.empty() ? root : beside_shared; }
  /// About one axis, root of the mean variance (rad).
  double rotation_sd_rad() const {
    return std::sqrt(covariance.bottomRightCorner<3, 3>().trace() / 3);
  }
};

/// Multiplies its variances.
void grow(PoseNoise& noise, double factor);

/// Covariance of the mean of `count` > 0 samples that follow each other by `step_s`.
Matrix6 covariance_of_mean(const PoseNoise& noise, std::size_t count, double step_s);

/// The noise of `motion`, at rest from `begin` to `end` (without). No variance is below that of
/// `least`.
PoseNoise noise_of(const ReferredMotion& motion, std::size_t begin, std::size_t end,
                   const Matrix6& least = Matrix6::Zero());

/// Turns the signs of the columns of a motion's components that a mirror at Y = 0 turns, of the
/// root of a covariance: it stays one.
void mirror_columns(Matrix6& root);

}  // namespace condyle::host
