// SPDX-License-Identifier: Apache-2.0
// Input and output of the recommended estimator.
#pragma once

#include <limits>

#include "condyle/estimator/events.h"
#include "condyle/estimator/math/arithmetic.h"
#include "condyle/estimator/provenance.h"
#include "condyle/estimator/sample.h"

namespace condyle {

/// The results for one axis at one instant. NaN and `not_computed` if there is no value.
template <class Scalar>
struct AxisEstimate {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();

  Quantity<Scalar> position_m, velocity_m_s, acceleration_m_s2, force_N;
  Scalar measured_position_m = kNone;  ///< as given
  Scalar innovation_m = kNone;         ///< measured minus predicted position
  Scalar innovation_sd_m = kNone;      ///< its standard deviation, predicted
  Scalar noise_sd_m = kNone;           ///< of the instrument, as estimated or given
  Scalar jerk_density_m2_s5 = kNone;   ///< of the motion, as estimated or given
  /// Shares of the learned corrections (motion_corrector.h) that are in velocity and acceleration,
  /// 0 to 1. 0: the filter's own values.
  Scalar velocity_learned = 0, acceleration_learned = 0;
};

/// The results of one step for one instant.
template <class Scalar>
struct RecommendedEstimate {
  static constexpr Scalar kNone = std::numeric_limits<Scalar>::quiet_NaN();

  bool is_ready = false;    ///< false while the lag fills
  TimeNs time_ns = 0;       ///< instant of the estimate
  bool time_valid = false;  ///< its time is known
  int axis_count = 0;
  AxisEstimate<Scalar> axes[3];
  Scalar nis = kNone;  ///< normalised innovation squared, one degree of freedom per axis
  EventSet events;     ///< unusual properties of the sample of that instant
};

/// A measured position and its time.
template <class Scalar, int kAxes>
struct TimedPosition {
  TimeNs time_ns = 0;
  bool is_measured = false;  ///< false: the position is missing, and the filter only predicts
  Array<Scalar, kAxes> position_m = {};
  EventSet events;         ///< unusual properties of the sample; passed on
  bool is_repeat = false;  ///< every coordinate repeats the last sample's, bit for bit
};

}  // namespace condyle
