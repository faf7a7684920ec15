// SPDX-License-Identifier: Apache-2.0
// When, on the host's clock, did the device measure? Reports carry the device's time d and arrive
// at h, which jitters: by the bus's polling, by a busy host, by bursts. Delays are never negative,
// so the earliest arrivals show how the two clocks lie to each other.
//
//   r = (h - h_0) - (d - d_0)     drift since the first report, plus the delay (ns)
//   r_k, d_k                      least r of second k, and when: what little delay there is at
//   least b     drift: median of the slopes between all pairs of (d_k, r_k) of the last 16 seconds
//         (Theil-Sen; P. K. Sen, J. Am. Stat. Assoc. 63 (1968) 1379-1389)
//   a     offset: median of r_k - b d_k
//   o     offset in use; goes to a + b d no faster than kSlew per device time beyond b, so that
//   time
//         between samples is never distorted by more
//   time  h_0 + (d - d_0) + o     the instant of measurement plus the least delay
//
// Before the first second is complete, least r so far stands for a and b = 0. The same reports give
// the same times, live and from a log.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "condyle/estimator/sample.h"

namespace condyle::hal {

/// Maps the time of a device that does not jump (see DeviceClock) to the host's clock. Constant
/// memory, no allocation.
class ClockFit {
 public:
  /// Host time of the measurement at `device_ns` that arrived at `arrival_ns`. Never before the one
  /// before; equal where both have the same device time.
  TimeNs add(TimeNs device_ns, TimeNs arrival_ns);

  /// The device's clock was set or started anew: nothing connects its times with those before.
  void restart() { has_origin_ = false; }

  /// Seconds that the fit rests on, at most 16; 0 while it is only the earliest arrival so far.
  int seconds_fitted() const { return count_; }
  /// How much slower the device's clock runs than the host's, parts per million.
  double drift_ppm() const { return drift_ * 1e6; }
  /// Spread of the earliest arrivals around the fit: one standard deviation (s), robust.
  double residual_s() const { return residual_ns_ * 1e-9; }
  /// How far the offset in use is still from the fitted one (s).
  double pending_s() const { return pending_ns_ * 1e-9; }

 private:
  static constexpr int kWindow = 16;         // seconds
  static constexpr double kSecond_ns = 1e9;  // of device time
  static constexpr double kSlew = 1e-3;

  void complete_second();
  static double median(double* values, int count) {
    std::nth_element(values, values + count / 2, values + count);
    return values[count / 2];
  }

  bool has_origin_ = false;
  TimeNs device_origin_ns_ = 0, host_origin_ns_ = 0;
  TimeNs last_time_ns_ = 0;
  bool has_time_ = false;
  double last_device_ns_ = 0;                          // all from the origin
  double second_begin_ns_ = 0;                         // of the second being collected
  double least_r_ns_ = 0, least_device_ns_ = 0;        // of it
  std::array<double, kWindow> least_r_{}, least_d_{};  // of complete ones
  int count_ = 0, next_ = 0;
  double offset_ns_ = 0, drift_ = 0;  // a, b
  double in_use_ns_ = 0;              // o
  double residual_ns_ = 0, pending_ns_ = 0;
};

}  // namespace condyle::hal
