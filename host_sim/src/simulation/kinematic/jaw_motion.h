// SPDX-License-Identifier: Apache-2.0
// The tasks of a kinematic jaw as smooth functions of time: four coordinates with continuous
// acceleration.
#pragma once

#include <string>
#include <vector>

#include "simulation/kinematic/jaw_scenario.h"
#include "simulation/kinematic/smooth_track.h"

namespace condyle::host {

/// The coordinates at an instant; all 0 at the reference position.
struct JawCoordinates {
  double left_m = 0, right_m = 0;  ///< advance x of the condyles in the frame of the fossae
  double lateral_m = 0;            ///< advance that moves the orbiting condyle inwards
  double opening_rad = 0;
  JawSide orbiting = JawSide::none;
};

struct JawTaskSpan {
  JawTaskKind kind = JawTaskKind::rest;
  double begin_s = 0, end_s = 0;
  std::string name() const { return jaw_task_name(kind); }
};

/// One movement out and back.
struct JawStroke {
  JawTaskKind kind = JawTaskKind::opening;
  int stroke = 1;
  double begin_s = 0, outward_end_s = 0, return_begin_s = 0, end_s = 0;
};

struct JawCycle {
  int sequence = 1, cycle = 1;  ///< counted in the task
  double begin_s = 0, opening_end_s = 0, end_s = 0;
  JawSide working = JawSide::left;
  bool is_reversed = false;
};

/// The motion of a scenario.
class JawMotionPlan {
 public:
  explicit JawMotionPlan(const JawScenario& scenario);

  JawCoordinates at(double time_s) const;
  double duration_s() const { return duration_s_; }
  /// Of a condyle, to 10 ms.
  double greatest_advance_m() const;
  const std::vector<JawTaskSpan>& tasks() const { return tasks_; }
  const std::vector<JawStroke>& strokes() const { return strokes_; }
  const std::vector<JawCycle>& cycles() const { return cycles_; }

 private:
  friend class JawMotionPlanner;

  SmoothTrack both_, left_, right_;  // advance of both condyles, and of each beyond it (m)
  SmoothTrack opening_;              // rad
  struct Orbit {
    double begin_s;
    JawSide orbiting;
  };
  std::vector<Orbit> orbits_;
  std::vector<JawTaskSpan> tasks_;
  std::vector<JawStroke> strokes_;
  std::vector<JawCycle> cycles_;
  double duration_s_ = 0;
};

}  // namespace condyle::host
