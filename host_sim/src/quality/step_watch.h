// SPDX-License-Identifier: Apache-2.0
// Detects frames that an instrument dropped under even time stamps, and positions that it held.
// Both are visible only in the motion: a step between two samples is two frames long, or none.
//
//   d_k   step of the position from sample k - 1 to sample k
//   s_k   the same for a straight line through three steps on either side; the step after a held
//         position may be twice as long, and is then left out
//   q_k   d_k . s_k / s_k^2: 1 if motion goes on, 2 if a frame is missing, 0 if it is held
//
// A step is judged if time stamps are even to 10 %, if it and its six neighbours lie within
// kScatter of the line and if s_k is at least kFewestGridSteps roundings long. Noise, uneven frames
// and irregular motion spread q about 1, with decreasing frequency. So there are at most as many
// steps with q within a quarter of 2 (of 0) as half-way to 1. If there are more than by chance in a
// share kFalseAlarm of recordings, frames were dropped (held).
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "condyle/estimator/motion/rounding_step.h"
#include "condyle/estimator/sample.h"

namespace condyle::host {

/// Watches the steps of one point. Constant memory.
class StepWatch {
 public:
  /// Probability that steps spread about 1 count as dropped (held) ones.
  static constexpr double kFalseAlarm = 1e-6;

  /// Adds a sample's position (m); with one axis the others are 0.
  void add(TimeNs time_ns, const std::array<double, 3>& position_m);
  /// Adds a sample without a position, or without a time.
  void add_missing();

  /// Steps that are two frames long.
  std::uint64_t dropped() const { return dropped_.there; }
  bool has_dropped() const { return dropped_.is_found(); }
  /// Steps of no length during motion.
  std::uint64_t held() const { return held_.there; }
  bool has_held() const { return held_.is_found(); }

 private:
  static constexpr std::size_t kSide = 3, kWindow = 2 * kSide + 2;
  static constexpr double kEven = 0.1, kScatter = 0.25;
  static constexpr double kFewestGridSteps = 5;

  using Vector = std::array<double, 3>;
  struct Step {
    Vector d_m;
    double duration_s;
  };
  // Steps with q about a value, and half-way between it and 1.
  struct Tally {
    double q;
    std::uint64_t there = 0, between = 0;
    void add(double ratio);
    bool is_found() const;
  };

  // q of the step at kSide, `left_out` of the steps after it left out; NaN if not judged.
  double ratio(std::size_t left_out) const;

  std::array<Step, kWindow> steps_{};  // the oldest first
  std::size_t count_ = 0;              // of `steps_` without a gap
  bool has_last_ = false;
  TimeNs last_time_ns_ = 0;
  Vector last_m_{};
  std::array<RoundingStep<double>, 3> roundings_;
  Tally dropped_{2}, held_{0};
};

}  // namespace condyle::host
