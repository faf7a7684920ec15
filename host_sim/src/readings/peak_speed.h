// SPDX-License-Identifier: Apache-2.0
// The greatest speed of a point, with an interval that knows how fast the point moves.
//
//   D_n    slope of the cubic of least squares through n samples on both sides
//   N      the widest window whose slope agrees with those of all narrower ones: at its own peak
//          within 1.8 standard deviations of the noise of their difference, at their peaks within
//          5.2, so that it passes over no burst of speed
//   value  D_n at that peak, n 1.6 times narrower, less what D_N - D_n says of its own error, which
//          grows with the fourth power of the width, and less what noise adds
// If even the narrowest windows differ by more than noise, the movement is fast for the rate: their
// differences are in the interval. Beyond 25 % of the speed, the value is hidden.
// Beside an abrupt change of the speed, as where teeth stop the jaw, D_n overshoots by up to 9 % of
// the change, however short the window: so much of the change within N is in the interval.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "readings/slope_noise.h"
#include "readings/strokes.h"
#include "readings/uncertainty.h"

namespace condyle::host {

/// The points whose speed is read.
enum class SpeedPoint { incisor, condyle_left, condyle_right };

/// The raw paths of these points around some samples of a motion.
class SpeedReader {
 public:
  /// For peaks in `run`. `part`: all, or the incisor only. `widest_s`: half the widest window.
  SpeedReader(const ReferredMotion& motion, SampleRun run, const PoseNoise& noise,
              const SharedErrors& errors, PathPart part, double widest_s = 0.4);

  /// The greatest speed (mm/s) of `point` at the samples of `run`. `way`: 0 the speed; 1 or -1 that
  /// up or down.
  UncertainValue greatest(SpeedPoint point, SampleRun run, int way);

 private:
  struct Peak;

  SampleRun window_at(std::size_t k, double half_s) const;
  Slope slope_at(std::size_t k, int width) const;
  double speed_at(const Places& places, std::size_t k, int width, int way);
  Eigen::Vector3d velocity_at(const Places& places, std::size_t k, int width) const;
  std::vector<Peak> peaks_of(const Places& places, SampleRun run, int way);
  Eigen::Matrix3d noise_of(SpeedPoint point, std::size_t k, const Matrix6& root) const;
  PointNoise noise_of(SpeedPoint point, std::size_t k, const Eigen::Vector3d& velocity) const;
  Places places_of(const ReadingGeometry& geometry, SpeedPoint point, std::size_t begin,
                   std::size_t end) const;
  bool passes_over(const Places& places, const Peak& burst, int width, int way,
                   const PointNoise& noise) const;
  double overshoot_at(const Places& places, std::size_t k, int width, int way);
  double noise_of_place(const Places& places, const Slope& slope, std::size_t k, int width, int way,
                        const NoiseAlong& noise);

  const ReferredMotion& motion_;
  const PoseNoise& noise_;
  const SharedErrors& errors_;
  PathPart part_;
  double widest_s_;
  std::size_t first_ = 0, last_ = 0;  // samples of the paths, last without
  double step_s_ = 0;
  JawPath path_;
  // By places, width and sample.
  std::map<std::pair<const Places*, int>, Places> velocities_;
};

}  // namespace condyle::host
