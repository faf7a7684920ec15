// SPDX-License-Identifier: Apache-2.0
// Recordings of a jaw point that chews under a measured force.
#pragma once

#include <vector>

#include "condyle/estimator/drive_timeline.h"
#include "consistency/driven_chewing.h"

namespace condyle::testing_support {

inline constexpr double kPositionSd_m = DrivenChewing::kPositionSd_m;
inline constexpr double kDriveSd_N = DrivenChewing::kDriveSd_N;

std::vector<DrivenSample> chew(const DrivenTruth& truth, double rate_Hz, unsigned seed,
                               double duration_s = 30);

/// Chewing whose curved drive and whose positions are measured apart, each at its own rate.
struct ApartRates {
  double drive_Hz = 60, position_Hz = 60;
  double first_position_s = 0.003;
  double drive_delay_s = 0;  ///< how late the drive is stamped
};
/// Gives the same chewing to each of `timelines`.
void chew_apart(const DrivenTruth& truth, const ApartRates& rates, unsigned seed,
                const std::vector<DriveTimeline<double>*>& timelines);
/// What `timeline` says at its end.
JointEstimate<double> chew_apart(const DrivenTruth& truth, const ApartRates& rates, unsigned seed,
                                 DriveTimeline<double> timeline);

}  // namespace condyle::testing_support
