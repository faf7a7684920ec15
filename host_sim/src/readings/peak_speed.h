// SPDX-License-Identifier: Apache-2.0
// The greatest speed of a point, with an interval that knows how fast the point moves.
//
//   D_n    slope of the cubic of least squares through n samples on both sides
//   N      the widest window whose slope agrees with those of all narrower ones: at its own peak
//          within 1.8 standard deviations of the noise of their difference, at their peaks within
//          what noise exceeds in one run of a thousand, for each width. So it passes over no burst
//   value  D_n at that peak, n 1.6 times narrower, less what D_N - D_n says of its own error, which
//          grows with the fourth power of the width, and less what noise adds
// In the interval, too:
//   - the differences of the narrowest windows if even they differ by more than noise: the movement
//     is fast for the rate. Beyond 25 % of the speed, the value is hidden
//   - where the slopes do not converge, as far as they may change; and the overshoot beside an
//     abrupt change of the speed (window_slopes.h)
//   - of strokes: bursts that the middle of the instrument's points or the incisor shows, which
//     often have less noise. As much as they change their velocity, the point may change its own
//   W      the widest window whose slope agrees with those of all narrower ones at its own peak. It
//          may pass over bursts
// If the point may move faster than the interval in a burst elsewhere, the value is hidden: in one
// over which N passes, or in one over which W passes and whose D_n plus two standard deviations
// exceeds the interval. N is often as wide as a burst, so that noise hides the burst from it.
#pragma once

#include <vector>

#include "readings/window_slopes.h"

namespace condyle::host {

/// The greatest speeds of points in a part of a motion.
class SpeedReader {
 public:
  /// For peaks in `run`. `part`: all, or the incisor only. `widest_s`: half the widest window.
  SpeedReader(const ReferredMotion& motion, SampleRun run, const PoseNoise& noise,
              const SharedErrors& errors, PathPart part, double widest_s = 0.4);

  /// The greatest speed (mm/s) of `point` at the samples of `run`. `way`: 0 the speed; 1 or -1 that
  /// up or down.
  UncertainValue greatest(SpeedPoint point, SampleRun run, int way);

 private:
  class Search;

  const std::vector<SharedNoise>& shared_;
  const SharedErrors& errors_;
  PathPart part_;
  WindowSlopes slopes_;
  double widest_s_;
};

}  // namespace condyle::host
