// SPDX-License-Identifier: Apache-2.0
// The ratios r = q / R, density of the jerk over variance of the noise (1/s^5), of a bank of
// white-jerk filters.
//
//   T       mean time step (s)
//   r T^5   what a filter's gain depends on (P. R. Kalata, The tracking index, IEEE Trans. Aerosp.
//           Electron. Syst. 20 (1984) 174-182)
//
// The lower ratios are half decades, from that of a calm jaw seen by a poor instrument on: there
// the error depends on r, whatever the sample time. The upper ones are spread up to
// r T^5 = kHighestIndex: there noise plays no part, and the filter only continues its last samples,
// so that a decade more changes its stated error but not its gain. With a noise of 1 um
// the highest expects the next sample within 1 um sqrt(kHighestIndex / 20) = 22 mm (sd): whatever
// a jaw does. A motion that lies inside at T lies inside at T/2 and T/4 too.
#pragma once

#include <algorithm>

#include "condyle/estimator/math/elementary.h"

namespace condyle {

/// Ratios of `kMembers` members for one sample time.
template <class Scalar, int kMembers>
class JerkDensityGrid {
 public:
  JerkDensityGrid() { span(kFirstStep_s); }

  /// Follows the mean time step; true if the ratios have changed. Small changes of the step, which
  /// the grid's range covers, leave them unchanged.
  bool follow(Scalar mean_step_s) {
    const double T = std::clamp(static_cast<double>(mean_step_s), kShortestStep_s, kLongestStep_s);
    if (T < step_s_ * kSlack && step_s_ < T * kSlack) return false;
    span(T);
    return true;
  }

  /// Ratio of member `i`, rising with it (1/s^5).
  Scalar operator[](int i) const { return ratios_[i]; }

 private:
  static constexpr double kLowest = 3.1622776601683795e6;  // 1/s^5
  static constexpr double kHalfDecade = 3.1622776601683795;
  static constexpr int kHalfDecades = 13;
  static constexpr double kHighestIndex = 1e10;
  static constexpr double kFirstStep_s = 0.01;
  static constexpr double kShortestStep_s = 5e-4, kLongestStep_s = 0.1;
  static constexpr double kSlack = 1.5;

  void span(double T) {
    step_s_ = T;
    const double highest = kHighestIndex / (T * T * T * T * T);
    double ratio = kLowest;
    for (int i = 0; i < kHalfDecades; ++i) {
      ratios_[i] = static_cast<Scalar>(ratio);
      ratio *= kHalfDecade;
    }
    ratio /= kHalfDecade;
    const double spacing =
        elementary::exp(elementary::log(highest / ratio) / (kMembers - kHalfDecades));
    for (int i = kHalfDecades; i < kMembers; ++i) {
      ratio *= spacing;
      ratios_[i] = static_cast<Scalar>(ratio);
    }
  }

  double step_s_ = 0;
  Array<Scalar, kMembers> ratios_ = {};
};

}  // namespace condyle
