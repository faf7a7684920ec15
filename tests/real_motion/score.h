// SPDX-License-Identifier: Apache-2.0
// How good an estimator is on real recordings, and the mean over many axes.
#pragma once

#include <string>
#include <vector>

#include "real_motion/track.h"

namespace condyle::testing_support {

/// An estimator along one axis of a recording. The first samples do not count: 0.3 s or 20 of them,
/// an eighth of a short recording. NaN where there is nothing to judge.
struct AxisScore {
  /// Velocity error (m/s, rms), and the share of 95 % intervals that hold the reference, whose own
  /// uncertainty counts.
  double velocity_error_m_s = 0, velocity_coverage = 0;
  /// Share of 95 % intervals of the next sample that hold it, where that is valid.
  double next_coverage = 0;
  std::size_t valid = 0, valid_refused = 0;
  /// Runs of 2 samples or more whose position is outside of the five samples around by more than 5
  /// of its standard deviations and 5 of the noise, not at an irregular sample.
  std::size_t runaways = 0;
  /// Samples that are not taken, at which the stated deviation of the position falls by 1 % or
  /// more.
  std::size_t deviation_falls = 0;
  std::string places;  ///< of runaways and falls, for messages
};
AxisScore score(const MotionRecording& recording, const ReferenceMotion& reference,
                const Track& track);

/// All that is compared along one axis.
struct AxisScores {
  std::string recording, instrument;
  char axis = 'x';
  AxisScore oracle, filter, recommended, published;  ///< filter: recommended without learning
};
/// Scores of the axes of `treated` that can be judged.
std::vector<AxisScores> score_axes(const TreatedRecording& treated);
/// The same of all `recordings` after `treatment`, in their order.
std::vector<AxisScores> score_all(const std::vector<MotionRecording>& recordings,
                                  Treatment treatment, unsigned seed = 1);
/// The same against the true velocity of simulated chewing along one axis, all of whose samples are
/// valid.
AxisScores score_axis(const MotionRecording& recording, const Values& velocity_m_s, double noise_m);

/// One estimator over several axes.
struct Summary {
  std::size_t axes = 0;
  double error_ratio = 0;       ///< velocity error over the oracle's: geometric mean,
  double error_ratio_95th = 0;  ///< 95th percentile,
  double worst_error_ratio = 0;
  double velocity_coverage = 0, next_coverage = 0;  ///< mean over axes
  double refused_percent = 0;                       ///< of all valid samples
  std::size_t runaways = 0, deviation_falls = 0;
};
/// Of the estimator `which` of `scores`.
Summary summarise(const std::vector<AxisScores>& scores, AxisScore AxisScores::*which);

}  // namespace condyle::testing_support
