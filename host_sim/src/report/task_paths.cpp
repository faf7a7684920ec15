// SPDX-License-Identifier: Apache-2.0
#include "report/task_paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "readings/strokes.h"

namespace condyle::host {
namespace {

constexpr std::size_t kMostPoints = 8'000;  // of a drawing
// Of many tasks some are drawn, so that each may have so many points: four seconds or more.
constexpr std::size_t kEnoughPoints = 250;
// Of a task with more than its share, so many stretches of about so many points, or longer ones.
constexpr std::size_t kMostStretches = 12, kStretchPoints = 100;
// Below the step at 60 Hz: of a faster recording, samples are left out.
constexpr double kDrawnStep_s = 0.012;

// A sample that is drawn if its task is drawn whole.
struct DrawableSample {
  std::size_t index;
  bool is_after_gap;
};

// The first and last sample before and after each gap are among them.
std::vector<DrawableSample> drawable_samples(const std::vector<double>& time_s, SampleRun task,
                                             double gap_s) {
  std::vector<DrawableSample> samples;
  for (const SampleRun& run : runs_without_gap(time_s, task, gap_s)) {
    double drawn_s = -INFINITY;
    for (std::size_t k = run.begin; k < run.end; ++k) {
      if (k + 1 < run.end && time_s[k] - drawn_s < kDrawnStep_s - 1e-9) continue;
      samples.push_back({k, k == run.begin});
      drawn_s = time_s[k];
    }
  }
  return samples;
}

// Points that a task may have, so that all have no more than a drawing: short ones keep theirs.
std::size_t most_of_each(std::vector<std::size_t> points) {
  std::sort(points.begin(), points.end());
  std::size_t left = kMostPoints;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t share = left / (points.size() - i);
    if (points[i] > share) return share;
    left -= points[i];
  }
  return kMostPoints;
}

// Whether each task is drawn if each `every`-th of its name that has samples is.
std::vector<bool> drawn_tasks(const std::vector<Task>& tasks,
                              const std::vector<std::size_t>& points, std::size_t every) {
  std::map<std::pair<TaskKind, Side>, std::size_t> seen;
  std::vector<bool> is_drawn;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    is_drawn.push_back(points[t] == 0 || seen[{tasks[t].kind, tasks[t].side}]++ % every == 0);
  }
  return is_drawn;
}

struct Choice {
  std::vector<bool> is_drawn;
  std::size_t most;  // points of each
};

// Draws as many tasks as leaves enough points to each.
Choice choose(const std::vector<Task>& tasks, const std::vector<std::size_t>& points) {
  Choice choice;
  for (std::size_t every = 1; every == 1 || every <= tasks.size(); ++every) {
    choice.is_drawn = drawn_tasks(tasks, points, every);
    std::vector<std::size_t> drawn;
    for (std::size_t t = 0; t < tasks.size(); ++t) {
      if (choice.is_drawn[t]) drawn.push_back(points[t]);
    }
    choice.most = most_of_each(drawn);
    if (choice.most >= kEnoughPoints) break;
    if (std::all_of(drawn.begin(), drawn.end(), [&](auto n) { return n <= choice.most; })) break;
  }
  return choice;
}

// `most` of the samples: evenly spaced stretches, the first and the last at the ends.
std::vector<std::vector<Eigen::Vector3d>> pieces_of(const std::vector<DrawableSample>& samples,
                                                    const std::vector<Eigen::Vector3d>& path_m,
                                                    std::size_t most) {
  const bool is_whole = samples.size() <= most;
  const std::size_t stretches =
      is_whole ? 1 : std::clamp<std::size_t>(most / kStretchPoints, 2, kMostStretches);
  const std::size_t length = is_whole ? samples.size() : most / stretches;
  std::vector<std::vector<Eigen::Vector3d>> pieces_m;
  std::size_t next = 0;
  for (std::size_t i = 0; i < stretches; ++i) {
    const std::size_t begin = is_whole ? 0 : i * (samples.size() - length) / (stretches - 1);
    for (std::size_t k = begin; k < begin + length; ++k) {
      if (samples[k].is_after_gap || k != next) pieces_m.emplace_back();
      pieces_m.back().push_back(path_m[samples[k].index]);
      next = k + 1;
    }
  }
  return pieces_m;
}

}  // namespace

TaskPaths task_paths(const Analysis& analysis, const std::vector<Eigen::Vector3d>& path_m) {
  const auto& time_s = analysis.path.time_s;
  const double gap_s = longest_drawn_gap_s(time_s);
  const auto samples_in = [&](const Task& task) {
    return drawable_samples(time_s, samples_of(task, time_s), gap_s);
  };
  std::vector<std::size_t> points;
  for (const Task& task : analysis.tasks) points.push_back(samples_in(task).size());
  const auto [is_drawn, most] = choose(analysis.tasks, points);
  TaskPaths tasks;
  for (std::size_t t = 0; t < points.size(); ++t) {
    const Task& task = analysis.tasks[t];
    DrawnPath path{task.kind == TaskKind::whole ? "whole" : name_of(task.kind), {}};
    if (is_drawn[t]) {
      path.pieces_m = pieces_of(samples_in(task), path_m, most);
      if (points[t] > most) ++tasks.in_parts;
    } else {
      ++tasks.left_out;
    }
    tasks.paths.push_back(std::move(path));
  }
  return tasks;
}

std::string what_is_missing(const TaskPaths& tasks) {
  const auto drawn = static_cast<std::size_t>(
      std::count_if(tasks.paths.begin(), tasks.paths.end(),
                    [](const DrawnPath& path) { return !path.pieces_m.empty(); }));
  std::string text;
  if (tasks.left_out > 0) {
    text = fmt::format("Only {} of {} tasks are drawn.", drawn, drawn + tasks.left_out);
  }
  if (tasks.in_parts > 0) {
    text += fmt::format("{}Of {} task{}, only parts are drawn.", text.empty() ? "" : " ",
                        tasks.in_parts, tasks.in_parts == 1 ? "" : "s");
  }
  return text;
}

}  // namespace condyle::host
