// SPDX-License-Identifier: Apache-2.0
// What an estimator says along one axis of a recording.
#pragma once

#include <vector>

#include "real_motion/recordings.h"
#include "real_motion/reference.h"

namespace condyle::testing_support {

/// Sample by sample; NaN where nothing is said.
struct Track {
  Values position_m, position_sd_m, velocity_m_s, velocity_sd_m_s, innovation_m, innovation_sd_m;
  Marks is_refused;    ///< taken for an outlier
  Marks is_repeated;   ///< taken for no measurement
  Marks is_restarted;  ///< the filter starts anew there

  explicit Track(std::size_t samples);
};

/// The recommended estimator, all axes at once, with so many kernels for learning.
std::vector<Track> recommended_tracks(const MotionRecording& recording, int kernels);

/// The published cascade with its default parameters, axis by axis; its sample time is the
/// recording's.
std::vector<Track> published_tracks(const MotionRecording& recording);

/// The white-jerk filter that knows which samples are irregular and, of each axis, noise R and
/// jerk density r R, constant: the most likely of 57 values of r from 1e4 to 1e18 (1/s^5), and R.
std::vector<Track> oracle_tracks(const TreatedRecording& treated,
                                 const std::vector<ReferenceMotion>& axes);

}  // namespace condyle::testing_support
