// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "condyle/estimator/sensors/driven_sensor.h"
#include "condyle/firmware/ring.h"

namespace condyle::box {

/// What an estimate of a microcontroller's says of its way.
struct NodeMark {
  enum class State : std::uint8_t {
    none,  ///< the box made it itself
    on_time,
    late,
    away,  ///< there is no estimate: the microcontroller is away or silent
  };
  State state = State::none;
  TimeNs delay_ns = 0;           ///< since the arrival of the report that led to it
  std::uint64_t connection = 0;  ///< of the microcontroller; its estimator starts anew with each
};

/// An estimate on its way to the outlets.
struct BoxEstimate {
  std::uint64_t run = 0;     ///< the estimator started anew with it; a recording is a run
  std::uint64_t number = 0;  ///< of the estimate in its run, from 1 on
  TimeNs arrival_ns = 0;     ///< of the report that led to it
  NodeMark node;
  bool has_joint = false;  ///< the facebow measures a drive: `estimate.joint` holds
  DrivenEstimate<double> estimate;
};

/// 8 s at 500 Hz.
using EstimateRing = firmware::Ring<BoxEstimate, 4096>;

}  // namespace condyle::box
