// SPDX-License-Identifier: Apache-2.0
// Finds the ends of chewing cycles.
//
//   p, v      position (m), velocity (m/s) along the axis, estimated
//   d         least travel (m)
//
// A cycle goes from one upward zero crossing of v to the next one before which p has risen by at
// least d and fallen by at least d. Crossings in between do not count. A crossing before p has
// risen restarts the cycle. So a pause, in which noise makes crossings, does not belong to a cycle,
// except for its last tenths of a second.
#pragma once

#include <cstdint>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// The place of a sample in the cycles.
enum class CyclePlace : std::uint8_t {
  outside,  ///< no cycle has begun
  begin,    ///< one begins after this sample; an unfinished one before it is dropped
  within,   ///< it is within one
  end,      ///< one ends with this sample, the next begins after it
};

/// Cuts a motion into cycles. Fixed size, no allocation; see above.
template <class Scalar>
class CycleSegmentation {
 public:
  /// `travel` is d, > 0.
  explicit CycleSegmentation(Scalar travel) : travel_m_(travel) {}

  /// The next sample. Both finite.
  CyclePlace add(Scalar p, Scalar v) {
    CyclePlace place = has_begun_ ? CyclePlace::within : CyclePlace::outside;
    const bool is_crossing = velocity_m_s_ <= Scalar(0) && v > Scalar(0);  // false for NaN
    velocity_m_s_ = v;
    if (is_crossing && (has_fallen_ || !has_risen_)) {
      place = has_fallen_ ? CyclePlace::end : CyclePlace::begin;
      has_begun_ = true;
      has_risen_ = has_fallen_ = false;
      turning_m_ = p;
    }
    if (!has_begun_) return place;
    if (!has_risen_) {
      if (p < turning_m_) turning_m_ = p;
      has_risen_ = p - turning_m_ >= travel_m_;
      if (has_risen_) turning_m_ = p;
    } else {
      if (p > turning_m_) turning_m_ = p;
      has_fallen_ = has_fallen_ || turning_m_ - p >= travel_m_;
    }
    return place;
  }

  /// Forgets the current cycle.
  void reset() { *this = CycleSegmentation(travel_m_); }

 private:
  Scalar travel_m_;
  bool has_begun_ = false, has_risen_ = false, has_fallen_ = false;
  Scalar turning_m_ = 0;  ///< lowest position before it has risen, then the highest
  Scalar velocity_m_s_ = std::numeric_limits<Scalar>::quiet_NaN();  ///< at the last sample
};

}  // namespace condyle
