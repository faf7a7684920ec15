// SPDX-License-Identifier: Apache-2.0
// What to do with a sample that the filter did not expect.
//
//   d    deviation: |innovation| in its standard deviations, the largest of all axes
//   d <= huber      the sample counts in full
//   d <= gate       it counts with weight huber / d (P. J. Huber, Ann. Math. Statist. 35 (1964) 73)
//   d >  gate       it is rejected: chi-square gate with 1 degree of freedom, threshold gate^2
//   after N rejections in a row it is the filter that is wrong, and it starts anew
#pragma once

#include "condyle/estimator/events.h"
#include "condyle/estimator/recommended_parameters.h"

namespace condyle {

/// How a sample is taken.
template <class Scalar>
struct Acceptance {
  Scalar weight = 1;     ///< the measurement variance is divided by it; 0: rejected
  bool restart = false;  ///< the filter starts anew from this sample
  EventSet events;
};

/// Judges one sample after the other.
template <class Scalar>
class OutlierGate {
 public:
  explicit OutlierGate(const OutlierParameters& parameters)
      : huber_sd_(static_cast<Scalar>(parameters.huber_sd)),
        gate_sd_(static_cast<Scalar>(parameters.gate_sd)),
        reset_after_(static_cast<Scalar>(parameters.reset_after)) {}

  /// Judges a sample of squared deviation `deviation_squared`, no unit. NaN is rejected.
  Acceptance<Scalar> judge(Scalar deviation_squared) {
    Acceptance<Scalar> acceptance;
    if (!is_doubtful(deviation_squared)) {
      rejections_ = 0;
    } else if (!is_outlier(deviation_squared)) {
      rejections_ = 0;
      acceptance.weight = huber_sd_ / std::sqrt(deviation_squared);
      acceptance.events.add(Event::outlier_weighted);
    } else {
      ++rejections_;
      acceptance.weight = 0;
      acceptance.restart = static_cast<Scalar>(rejections_) >= reset_after_;
      acceptance.events.add(Event::outlier_rejected);
    }
    return acceptance;
  }

  /// True where a sample of squared deviation `deviation_squared` would be rejected.
  bool is_outlier(Scalar deviation_squared) const {
    return !(deviation_squared <= gate_sd_ * gate_sd_);
  }
  /// True where it would not count in full.
  bool is_doubtful(Scalar deviation_squared) const {
    return !(deviation_squared <= huber_sd_ * huber_sd_);
  }

  /// Samples rejected in a row, the last included.
  int rejections() const { return rejections_; }

  /// The filter has started anew.
  void restart() { rejections_ = 0; }

 private:
  Scalar huber_sd_, gate_sd_, reset_after_;
  int rejections_ = 0;
};

}  // namespace condyle
