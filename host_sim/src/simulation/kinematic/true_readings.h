// SPDX-License-Identifier: Apache-2.0
// Readings of the true motion, each by its definition on noise-free poses. They depend on the
// subject and the tasks alone, not on the instrument.
//
// d: displacement of the lower incisor, c: of a condyle, both from the reference position in A
// (mm); s = sqrt(x^2 + z^2) of c: its travel. y_medial: -y of the left condyle, +y of the right
// one.
#pragma once

#include <string>
#include <vector>

#include "simulation/kinematic/kinematic_jaw.h"

namespace condyle::host {

/// A reading. A travel that a stroke does not reach gives none.
struct TrueReading {
  std::string task;
  std::string side;  ///< "left", "right" or empty
  int stroke = 0;  ///< 1, 2, ... in the task; a cycle in chewing; 0: their mean, or the whole task
  std::string reading;
  double value = 0;
  std::string unit;  ///< "mm", "deg", "s", "Hz", "mm/s", "1"
};

std::vector<TrueReading> true_readings(const KinematicJaw& jaw);

/// The cycles of chewing, with the true instant of the greatest opening. Incisor at its highest at
/// begin_s and end_s; the first of a sequence begins when the jaw leaves the reference position.
std::vector<JawCycle> true_cycles(const KinematicJaw& jaw);

}  // namespace condyle::host
