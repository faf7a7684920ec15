// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "readings/strokes.h"
#include "readings/task_readings.h"

namespace condyle::host {
namespace {

constexpr std::size_t kLeastChewingCycles = 4;
constexpr double kLongestOpen_s = 1.6, kHighest_m = 30e-3;  // of a chewing cycle
constexpr double kNewSequence_s = 2;
constexpr double kLeastFoundStroke_m = 3e-3;
constexpr double kLeastShare = 0.5;  // of the greatest stroke of the same kind

}  // namespace

std::vector<Task> found_tasks(const JawPath& path, const TaskContext& context) {
  std::vector<Task> tasks;
  if (!context.has_landmarks) return tasks;
  const auto& time_s = path.time_s;
  // Chewing: at least four short and low cycles in a row. Openings may follow one another as fast.
  const std::vector<double> heights_m = heights_of(path, true);
  const auto cycles = find_cycles(time_s, heights_m, 0, {0, time_s.size()});
  const auto is_chewing = [&heights_m](const ChewingCycle& cycle) {
    return cycle.rejected.empty() && cycle.open_s <= kLongestOpen_s &&
           heights_m[cycle.begin] - heights_m[cycle.turn] <= kHighest_m;
  };
  std::vector<bool> chewed(time_s.size(), false);
  for (std::size_t i = 0; i < cycles.size();) {
    std::size_t j = i;
    while (j < cycles.size() && is_chewing(cycles[j]) &&
           (j == i || cycles[j].begin_s - cycles[j - 1].end_s <= kNewSequence_s)) {
      ++j;
    }
    if (j - i >= kLeastChewingCycles) {
      tasks.push_back({TaskKind::chewing, cycles[i].begin_s, cycles[j - 1].end_s, true});
      std::fill(chewed.begin() + static_cast<std::ptrdiff_t>(cycles[i].begin),
                chewed.begin() + static_cast<std::ptrdiff_t>(cycles[j - 1].end + 1), true);
    }
    i = std::max(j, i + 1);
  }
  std::vector<double> distance_m;
  for (const auto& point : path.incisor_m) distance_m.push_back(point.norm());
  std::vector<std::pair<Task, double>> strokes;
  for (std::size_t begin = 0; begin < time_s.size();) {
    std::size_t end = begin;
    while (end < time_s.size() && !chewed[end]) ++end;
    // Strokes of different kinds differ in size: one after the other, each by the least height.
    for (const SampleRun& run : find_strokes_alone(distance_m, begin, end, kLeastFoundStroke_m)) {
      const auto top = std::max_element(distance_m.begin() + static_cast<std::ptrdiff_t>(run.begin),
                                        distance_m.begin() + static_cast<std::ptrdiff_t>(run.end));
      const auto kind =
          kind_of_stroke(path.incisor_m[static_cast<std::size_t>(top - distance_m.begin())]);
      if (kind) strokes.push_back({{*kind, time_s[run.begin], time_s[run.end - 1], true}, *top});
    }
    begin = end + 1;
  }
  // What is far smaller than the others of its kind is another movement: a swallow, a word.
  std::map<TaskKind, double> greatest_m;
  for (const auto& [task, height_m] : strokes) {
    greatest_m[task.kind] = std::max(greatest_m[task.kind], height_m);
  }
  for (const auto& [task, height_m] : strokes) {
    if (height_m >= kLeastShare * greatest_m[task.kind]) tasks.push_back(task);
  }
  std::sort(tasks.begin(), tasks.end(),
            [](const Task& a, const Task& b) { return a.begin_s < b.begin_s; });
  return tasks;
}

}  // namespace condyle::host
