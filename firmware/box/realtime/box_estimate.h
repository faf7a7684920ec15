// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "condyle/estimator/pose/pose_estimate.h"
#include "condyle/estimator/sensors/driven_sensor.h"
#include "condyle/firmware/ring.h"

namespace condyle::box {

/// How an estimate from a microcontroller arrived.
struct NodeMark {
  enum class State : std::uint8_t {
    none,  ///< the box made it itself
    on_time,
    late,
    away,  ///< there is no estimate: the microcontroller is away or silent
  };
  State state = State::none;
  TimeNs delay_ns = 0;           ///< since the arrival of the report it answers
  std::uint64_t connection = 0;  ///< of the microcontroller; its estimator restarts with each
};

/// An estimate on its way to the outlets.
struct BoxEstimate {
  std::uint64_t run = 0;     ///< the estimator restarts with each run; a recording is a run
  std::uint64_t number = 0;  ///< of the estimate in its run, from 1
  TimeNs arrival_ns = 0;     ///< of the report it answers
  NodeMark node;
  bool has_impedance = false;  ///< the facebow measures a drive: `estimate.impedance` holds
  DrivenEstimate<double> estimate;
  bool has_pose = false;  ///< `pose` holds; it may be without values
  PoseEstimate<double> pose;
};

/// 8 s at 500 Hz.
using EstimateRing = firmware::Ring<BoxEstimate, 4096>;

}  // namespace condyle::box
