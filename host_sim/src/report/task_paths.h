// SPDX-License-Identifier: Apache-2.0
// The paths of tasks, of so few points that a page stays small.
#pragma once

#include <string>
#include <vector>

#include "readings/analysis.h"
#include "report/plane_drawing.h"

namespace condyle::host {

/// The paths of the tasks of an analysis, one each.
struct TaskPaths {
  std::vector<DrawnPath> paths;  ///< without pieces: left out, or without samples
  std::size_t left_out = 0;      ///< number of tasks that are not drawn: there are many
  std::size_t in_parts = 0;      ///< number of tasks of which only parts are drawn: they are long
};

/// The tasks of `analysis` along `path_m`, one of its paths.
TaskPaths task_paths(const Analysis& analysis, const std::vector<Eigen::Vector3d>& path_m);

/// Sentences that say what is not drawn; empty if all is. Tasks without samples do not count.
std::string what_is_missing(const TaskPaths& tasks);

}  // namespace condyle::host
