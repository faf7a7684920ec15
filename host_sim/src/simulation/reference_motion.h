// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "condyle/estimator/sample.h"

namespace condyle::host {

/// The intended followed coordinate.
struct MotionPoint {
  double position_m = 0;
  double velocity_m_s = 0;
  double acceleration_m_s2 = 0;
};

/// The task of a subject. Cycles leave the rest position, reach an extreme and return, each way
/// along a minimum-jerk quintic, so that position, velocity and acceleration are continuous.
struct MotionTask {
  double rest_position_m = -0.001;  ///< position between cycles
  double amplitude_m = 0;           ///< depth of a cycle, towards negative positions (opening)
  double amplitude_spread = 0;      ///< its relative standard deviation
  bool alternates = false;          ///< every second cycle goes to the other side
  double cycle_rate_Hz = 1;         ///< cycles per second, without pauses
  double rate_spread = 0;           ///< its relative standard deviation
  double dwell_share = 0;           ///< share of a cycle spent at rest
  double pause_probability = 0;     ///< of a pause after a cycle
  double pause_s = 1;               ///< its length
  double tremor_m = 0;              ///< amplitude of each of three tremor components
  double tremor_Hz = 8;             ///< frequency of the middle one
};

/// Random numbers of the motion: standard normal and uniform.
struct Draws {
  std::function<double()> normal, uniform;
};

/// The motion of a task, evaluated at times that never run backwards.
class ReferenceMotion {
 public:
  ReferenceMotion(const MotionTask& task, Draws draws);
  MotionPoint at(double time_s);

 private:
  struct Cycle {
    double start_s, way_s, rest_s, depth_m;  // two ways of way_s, then rest_s at rest
  };
  void next_cycle(double start_s);

  MotionTask task_;
  Draws draws_;
  Cycle cycle_{};
  double phases_[3] = {};
  double side_ = 1;
};

}  // namespace condyle::host
