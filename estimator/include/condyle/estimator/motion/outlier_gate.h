// SPDX-License-Identifier: Apache-2.0
// Decides on samples that the filter did not expect.
//
//   d    deviation: |innovation| in its standard deviations, the largest of all axes
//   d <= huber      the sample counts in full
//   d <= gate       it counts with weight huber / d (P. J. Huber, Ann. Math. Statist. 35 (1964) 73)
//   d >  gate       it is an outlier, or the motion has changed (motion_hypotheses.h)
#pragma once

#include <cmath>

#include "condyle/estimator/motion/motion_parameters.h"

namespace condyle {

/// The limits of the deviation, and the weights.
template <class Scalar>
class OutlierGate {
 public:
  explicit OutlierGate(const OutlierParameters& parameters)
      : huber_sd_(static_cast<Scalar>(parameters.huber_sd)),
        gate_sd_(static_cast<Scalar>(parameters.gate_sd)) {}

  /// True if a sample of squared deviation `deviation_squared`, no unit, does not fit; false for
  /// NaN.
  bool is_outlier(Scalar deviation_squared) const {
    return !(deviation_squared <= gate_sd_ * gate_sd_);
  }
  /// True if it does not count in full.
  bool is_doubtful(Scalar deviation_squared) const {
    return !(deviation_squared <= huber_sd_ * huber_sd_);
  }
  /// Its weight, at most 1: the measurement variance is divided by it. Requires that `is_outlier`
  /// is false.
  Scalar weight(Scalar deviation_squared) const {
    return is_doubtful(deviation_squared) ? huber_sd_ / std::sqrt(deviation_squared) : Scalar(1);
  }

 private:
  Scalar huber_sd_, gate_sd_;
};

}  // namespace condyle
