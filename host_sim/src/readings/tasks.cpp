// SPDX-License-Identifier: Apache-2.0
#include "readings/tasks.h"

#include <fmt/format.h>

#include <algorithm>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "recordings/recording_formats.h"
#include "recordings/session_markers.h"

namespace condyle::host {
namespace {

constexpr std::pair<std::string_view, Side> kChewingSides[] = {{"chewing-left", Side::left},
                                                               {"chewing-right", Side::right}};

std::string all_names() {
  std::string text;
  for (const std::string_view name : task_names()) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", name);
  }
  for (const auto& [sided, side] : kChewingSides) text += fmt::format(", {}", sided);
  return text;
}

// Kind and side of the task called `name`; false if there is none.
bool find_name(std::string_view name, Task& task) {
  for (const auto& [sided, side] : kChewingSides) {
    if (name != sided) continue;
    task.kind = TaskKind::chewing;
    task.side = side;
    return true;
  }
  const auto names = task_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return false;
  task.kind = static_cast<TaskKind>(found - names.begin());
  return true;
}

double time_of(std::string_view text, const std::string& place, const char* what) {
  double value = 0;
  if (parse_number(text, value) != NumberStatus::ok) {
    throw InputError(place, fmt::format("{} is not a time", quote(text)),
                     fmt::format("give the {} in seconds on the recording's clock", what));
  }
  return value;
}

Task task_of(const std::string& place, const std::string& name, std::string_view begin,
             std::string_view end) {
  Task task;
  set_name(task, name, place);
  task.begin_s = time_of(begin, place, "begin");
  task.end_s = time_of(end, place, "end");
  if (!(task.end_s > task.begin_s)) {
    throw InputError(
        place, fmt::format("{} ends at {:g} s, not after {:g} s", name, task.end_s, task.begin_s),
        "give the begin, then the end");
  }
  return task;
}

}  // namespace

SampleRun samples_of(const Task& task, const std::vector<double>& time_s) {
  // Times are known to about a nanosecond.
  const auto begin = std::lower_bound(time_s.begin(), time_s.end(), task.begin_s - 1e-9);
  const auto end = std::upper_bound(begin, time_s.end(), task.end_s + 1e-9);
  return {static_cast<std::size_t>(begin - time_s.begin()),
          static_cast<std::size_t>(end - time_s.begin())};
}

TaskKind task_kind(const std::string& name, const std::string& place) {
  Task task;
  set_name(task, name, place);
  return task.kind;
}

void set_name(Task& task, const std::string& name, const std::string& place) {
  if (find_name(name, task)) return;
  throw InputError(place, fmt::format("{} is not a task", quote(name)),
                   fmt::format("tasks are {}", all_names()));
}

std::vector<Task> tasks_of_words(const std::vector<std::string>& words) {
  std::vector<Task> tasks;
  for (std::size_t i = 0; i + 2 < words.size(); i += 3) {
    tasks.push_back(task_of("--task", words[i], words[i + 1], words[i + 2]));
  }
  return tasks;
}

std::vector<Task> read_tasks(const std::string& path) {
  ByteReader reader(path);
  RowReader rows(reader);
  std::string_view row;
  const auto place = [&] { return fmt::format("{}:{}", path, rows.line()); };
  std::vector<std::string_view> fields;
  int columns[3] = {-1, -1, -1};
  constexpr const char* names[3] = {"task", "begin_s", "end_s"};
  if (!rows.next(row)) row = {};
  split_row(row, fields);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      if (fields[i] == names[k]) columns[k] = static_cast<int>(i);
    }
  }
  for (int k = 0; k < 3; ++k) {
    if (columns[k] < 0) {
      throw InputError(place(), fmt::format("no column {}", names[k]),
                       "the first line names the columns: task,begin_s,end_s");
    }
  }
  std::vector<Task> tasks;
  while (rows.next(row)) {
    if (row.empty()) continue;
    split_row(row, fields);
    std::string_view values[3];
    for (int k = 0; k < 3; ++k) {
      if (static_cast<std::size_t>(columns[k]) >= fields.size()) {
        throw InputError(place(), fmt::format("the row has no {}", names[k]),
                         "complete the row: task, begin and end");
      }
      values[k] = fields[static_cast<std::size_t>(columns[k])];
    }
    tasks.push_back(task_of(place(), std::string(values[0]), values[1], values[2]));
  }
  if (tasks.empty()) {
    throw InputError(path, "holds no task", "add rows such as opening,2.0,8.5");
  }
  return tasks;
}

std::vector<Task> marked_tasks(const std::string& path, double end_s) {
  const std::vector<SessionMarker> markers = read_markers(path);
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    Task task;
    if (!find_name(trim(markers[i].text), task)) continue;
    task.begin_s = seconds(markers[i].time_ns);
    task.end_s = i + 1 < markers.size() ? seconds(markers[i + 1].time_ns) : end_s;
    if (task.end_s > task.begin_s) tasks.push_back(task);
  }
  return tasks;
}

}  // namespace condyle::host
