// SPDX-License-Identifier: Apache-2.0
// What the subject did when: stated, marked in the session, or found.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "readings/reading.h"
#include "readings/sample_run.h"

namespace condyle::host {

/// A task and its time in the recording.
struct Task {
  TaskKind kind = TaskKind::opening;
  double begin_s = 0, end_s = 0;
  bool is_found = false;   ///< by the shape of the motion, not stated
  Side side = Side::none;  ///< of chewing, if it is stated
};

/// The samples of a recording at `time_s` from the task's beginning to its end, both included.
SampleRun samples_of(const Task& task, const std::vector<double>& time_s);

/// The kind called `name`. Throws InputError naming `place` if there is none.
TaskKind task_kind(const std::string& name, const std::string& place);

/// Takes kind and side from a task's name: that of a kind, or chewing-left, chewing-right. Throws
/// InputError naming `place` if it is none.
void set_name(Task& task, const std::string& name, const std::string& place);

/// The tasks of --task NAME BEGIN END, given `words` three by three.
std::vector<Task> tasks_of_words(const std::vector<std::string>& words);

/// The tasks of a CSV file with the columns task, begin_s, end_s. Problems are InputErrors that
/// name file, line and remedy.
std::vector<Task> read_tasks(const std::string& path);

/// The tasks that the markers of the session log `path` name: each lasts until the next marker, or
/// until `end_s`.
std::vector<Task> marked_tasks(const std::string& path, double end_s);

}  // namespace condyle::host
