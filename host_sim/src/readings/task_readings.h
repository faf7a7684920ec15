// SPDX-License-Identifier: Apache-2.0
// From tasks to readings: strokes and cycles, their values, their means, and what is withheld.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "readings/analysis.h"
#include "readings/uncertainty.h"

namespace condyle::host {

/// What the readings of a recording's tasks rest on.
struct TaskContext {
  const ReferredMotion* motion = nullptr;
  const PoseNoise* noise = nullptr;
  SharedErrors errors;
  bool has_landmarks = false;
  std::string condyle_assumption;     ///< of condylar readings; empty: the points are measured
  std::string landmark_assumption;    ///< on where the head was; empty: it is known, or still
  std::string reference_assumption;   ///< on the reference position; empty: it is known
  std::string smoothing_assumption;   ///< on fast movements; empty: the instrument does not smooth
  std::string rotation_problem;       ///< why readings that need rotation are withheld; empty: none
  std::string unusable;               ///< why all readings are withheld; empty: none
  std::function<bool()> should_stop;  ///< see analysis_stop.h; none: it runs to its end
};

/// The tasks that the path shows: chewing where cycles follow one another, single strokes by their
/// direction. None without landmarks.
std::vector<Task> found_tasks(const JawPath& path, const TaskContext& context);

/// Fills `analysis.readings` and `analysis.cycles` from its tasks and path.
void read_tasks_of(Analysis& analysis, const TaskContext& context);

}  // namespace condyle::host
