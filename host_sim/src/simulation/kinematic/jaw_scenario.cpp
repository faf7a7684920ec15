// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/jaw_scenario.h"

namespace condyle::host {

const char* jaw_side_name(JawSide side) {
  return side == JawSide::left ? "left" : side == JawSide::right ? "right" : "";
}

std::string jaw_task_name(JawTaskKind kind) {
  constexpr const char* names[kJawTaskKinds] = {"rest",  "opening", "protrusion", "left",
                                                "right", "border",  "chewing"};
  return names[static_cast<std::size_t>(kind)];
}

JawTask default_task(JawTaskKind kind) {
  JawTask task{.kind = kind};
  switch (kind) {
    case JawTaskKind::rest:
      break;
    case JawTaskKind::opening:
      task.advance_mm = 9.5;
      task.angle_deg = 26;
      break;
    case JawTaskKind::protrusion:
      task.advance_mm = 7.5;
      task.angle_deg = 1;
      task.stroke_s = 1.2;
      break;
    case JawTaskKind::left:
    case JawTaskKind::right:
      task.advance_mm = 7.2;
      task.angle_deg = 3;
      break;
    case JawTaskKind::border:
      task.advance_mm = 10;
      task.angle_deg = 28;
      task.strokes = 1;
      break;
    case JawTaskKind::chewing:
      task.duration_s = 20;
      task.advance_mm = 2.5;
      task.angle_deg = 9;
      task.size_spread = 0.12;
      break;
  }
  return task;
}

}  // namespace condyle::host
