// SPDX-License-Identifier: Apache-2.0
// The paths of tasks in a report's drawings: few points, no line over a gap, short tasks whole
// beside long ones, and a count of what is missing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "readings/strokes.h"
#include "report/task_paths.h"

namespace condyle::host {
namespace {

constexpr std::size_t kMostPoints = 8'000;
constexpr double kStep_s = 0.012;

using Generator = std::mt19937;
using Samples = std::vector<std::size_t>;

double uniform(Generator& generator, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(generator);
}

// From `low` to `high`, small ones as often as large ones.
double spread(Generator& generator, double low, double high) {
  return low * std::exp(uniform(generator, 0, std::log(high / low)));
}

constexpr std::pair<TaskKind, Side> kNames[] = {{TaskKind::opening, Side::none},
                                                {TaskKind::chewing, Side::left},
                                                {TaskKind::chewing, Side::right}};

// Tasks of three names in turn, one after another. Two rates, random steps, gaps, and perhaps an
// hour without samples. The x of each sample is its number.
Analysis random_analysis(Generator& generator, std::size_t tasks, double longest_s) {
  Analysis analysis;
  double end_s = 0;
  for (std::size_t i = 0; i < tasks; ++i) {
    Task task;
    std::tie(task.kind, task.side) = kNames[i % std::size(kNames)];
    task.begin_s = end_s;
    task.end_s = end_s += spread(generator, 0.05, longest_s);
    analysis.tasks.push_back(task);
  }
  const double rates_Hz[] = {spread(generator, 5, 300), spread(generator, 5, 300)};
  const double change_s = uniform(generator, 0, end_s), gaps_Hz = uniform(generator, 0, 0.2);
  const double recorded_s = end_s * (generator() % 3 == 0 ? uniform(generator, 0.1, 1) : 1);
  auto& time_s = analysis.path.time_s;
  for (double now_s = 0; now_s < recorded_s || time_s.size() < 2;) {
    time_s.push_back(now_s);
    const double step_s = uniform(generator, 0.7, 1.3) / rates_Hz[now_s < change_s ? 0 : 1];
    now_s += step_s;
    if (uniform(generator, 0, 1) < gaps_Hz * step_s) now_s += uniform(generator, 0, 2);
  }
  // Some tasks end with a sample, as those that are found, but for rounding.
  for (Task& task : analysis.tasks) {
    if (generator() % 2 == 0)
      task.end_s = std::max(task.begin_s, time_s[generator() % time_s.size()] - 5e-10);
  }
  if (generator() % 4 == 0) {
    const double pause_from_s = uniform(generator, 0, end_s);
    const auto later = [&](double& t) { t += t > pause_from_s ? 3600 : 0; };
    for (double& t : time_s) later(t);
    for (Task& task : analysis.tasks) later(task.begin_s), later(task.end_s);
  }
  if (generator() % 4 == 0) analysis.tasks.back().end_s = 1e300;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    analysis.path.incisor_m.emplace_back(static_cast<double>(k), 0, 0);
  }
  analysis.rate_Hz = static_cast<double>(time_s.size()) / end_s;
  return analysis;
}

// Replaces the samples by those of a recording at 60 Hz.
void record(Analysis& analysis, std::size_t duration_s) {
  analysis.path.time_s.clear();
  analysis.path.incisor_m.clear();
  for (std::size_t k = 0; k <= 60 * duration_s; ++k) {
    analysis.path.time_s.push_back(static_cast<double>(k) / 60);
    analysis.path.incisor_m.emplace_back(static_cast<double>(k), 0, 0);
  }
}

bool is_after_gap(const std::vector<double>& time_s, double gap_s, std::size_t k) {
  return time_s[k] - time_s[k - 1] > gap_s + 1e-9;
}

// What a drawing of the whole task shows: every sample that is 12 ms after the last one shown, and
// those before and after gaps.
Samples whole_task(const std::vector<double>& time_s, double gap_s, const Task& task) {
  Samples shown;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    if (time_s[k] < task.begin_s - 1e-9 || time_s[k] > task.end_s + 1e-9) continue;
    const bool is_first = shown.empty() || is_after_gap(time_s, gap_s, k);
    const bool is_last = k + 1 == time_s.size() || time_s[k + 1] > task.end_s + 1e-9 ||
                         is_after_gap(time_s, gap_s, k + 1);
    if (is_first || is_last || time_s[k] - time_s[shown.back()] >= kStep_s - 1e-9)
      shown.push_back(k);
  }
  return shown;
}

// The samples of a path. Checks that each piece is a part of `whole` without gaps.
Samples samples_in(const DrawnPath& path, const Samples& whole, const std::vector<double>& time_s,
                   double gap_s) {
  Samples all;
  for (const auto& piece : path.pieces_m) {
    EXPECT_FALSE(piece.empty());
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const auto sample = static_cast<std::size_t>(piece[i].x());
      const auto at = std::lower_bound(whole.begin(), whole.end(), sample);
      EXPECT_TRUE(at != whole.end() && *at == sample);
      EXPECT_TRUE(all.empty() || sample > all.back());
      if (i > 0 && at != whole.begin() && at != whole.end()) {
        EXPECT_EQ(*(at - 1), all.back());
        EXPECT_FALSE(is_after_gap(time_s, gap_s, sample));
      }
      all.push_back(sample);
    }
  }
  return all;
}

std::size_t longest_undrawn(const Samples& whole, const Samples& drawn) {
  std::size_t longest = 0, now = 0;
  for (const std::size_t sample : whole) {
    now = std::binary_search(drawn.begin(), drawn.end(), sample) ? 0 : now + 1;
    longest = std::max(longest, now);
  }
  return longest;
}

// Between evenly spaced stretches, one for each 100 points.
std::size_t longest_allowed(std::size_t whole, std::size_t drawn) {
  const std::size_t stretches = std::clamp<std::size_t>(drawn / 100, 2, 12);
  return (whole - drawn) / (stretches - 1) + 2;
}

struct Counts {
  std::size_t whole = 0, in_parts = 0, left_out = 0;
};

Counts expect_good(const Analysis& analysis) {
  const auto& time_s = analysis.path.time_s;
  const double gap_s = longest_drawn_gap_s(time_s);
  const TaskPaths tasks = task_paths(analysis, analysis.path.incisor_m);
  EXPECT_EQ(tasks.paths.size(), analysis.tasks.size());
  Counts counts;
  std::size_t points = 0, points_of_all = 0;
  std::set<std::pair<TaskKind, Side>> names, drawn_names;
  for (std::size_t t = 0; t < tasks.paths.size(); ++t) {
    SCOPED_TRACE(testing::Message() << "task " << t);
    const Task& task = analysis.tasks[t];
    const Samples whole = whole_task(time_s, gap_s, task);
    const Samples drawn = samples_in(tasks.paths[t], whole, time_s, gap_s);
    points += drawn.size();
    points_of_all += whole.size();
    if (!whole.empty()) names.insert({task.kind, task.side});
    if (!drawn.empty()) drawn_names.insert({task.kind, task.side});
    if (drawn == whole) {
      ++counts.whole;
      continue;
    }
    if (drawn.empty()) {
      ++counts.left_out;
      continue;
    }
    ++counts.in_parts;
    EXPECT_GE(drawn.size(), 230U);
    EXPECT_LE(longest_undrawn(whole, drawn), longest_allowed(whole.size(), drawn.size()));
    EXPECT_EQ(drawn.front(), whole.front());
    EXPECT_EQ(drawn.back(), whole.back());
  }
  EXPECT_LE(points, kMostPoints);
  EXPECT_GE(points, std::min(points_of_all, kMostPoints) / 5);
  EXPECT_EQ(counts.left_out, tasks.left_out);
  EXPECT_EQ(counts.in_parts, tasks.in_parts);
  EXPECT_EQ(drawn_names, names);
  return counts;
}

TEST(TaskPaths, AreWholeOrHaveEnoughPointsAndBothEnds) {
  Generator generator(1);
  Counts all;
  for (int run = 0; run < 150; ++run) {
    SCOPED_TRACE(testing::Message() << "run " << run);
    const std::size_t tasks = 1 + generator() % 100;
    const double longest_s = spread(generator, 1, 400);
    const Counts counts = expect_good(random_analysis(generator, tasks, longest_s));
    all.whole += counts.whole;
    all.in_parts += counts.in_parts;
    all.left_out += counts.left_out;
  }
  EXPECT_GT(all.whole, 100U);
  EXPECT_GT(all.in_parts, 50U);
  EXPECT_GT(all.left_out, 20U);
}

TEST(TaskPaths, OfVeryManyAreSomeOfEachName) {
  Generator generator(2);
  for (const std::size_t count : {50U, 100U, 1000U}) {
    SCOPED_TRACE(testing::Message() << count << " tasks");
    Analysis analysis = random_analysis(generator, count, 1);
    for (std::size_t t = 0; t < count; ++t) {
      analysis.tasks[t].begin_s = static_cast<double>(4 * t);
      analysis.tasks[t].end_s = static_cast<double>(4 * t + 4);
    }
    record(analysis, 4 * count);
    expect_good(analysis);
    const TaskPaths tasks = task_paths(analysis, analysis.path.incisor_m);
    // All that are drawn are whole.
    EXPECT_EQ(tasks.in_parts, 0U);
    std::map<std::pair<TaskKind, Side>, std::size_t> drawn;
    for (std::size_t t = 0; t < count; ++t) {
      if (!tasks.paths[t].pieces_m.empty()) {
        ++drawn[{analysis.tasks[t].kind, analysis.tasks[t].side}];
      }
    }
    ASSERT_EQ(drawn.size(), std::size(kNames));
    for (const auto& [name, number] : drawn) EXPECT_GE(number, count == 50 ? 8U : 4U);
    EXPECT_EQ(what_is_missing(tasks), "Only " + std::to_string(count - tasks.left_out) + " of " +
                                          std::to_string(count) + " tasks are drawn.");
  }
}

// Twelve movements of ten seconds and a minute of chewing on each side.
TEST(TaskPaths, OfASessionAreAllDrawn) {
  Analysis analysis;
  for (int t = 0; t < 14; ++t) {
    Task task;
    task.kind = t < 12 ? static_cast<TaskKind>(t / 3) : TaskKind::chewing;
    task.begin_s = t < 13 ? 10 * t : 180;
    task.end_s = t < 12 ? task.begin_s + 10 : task.begin_s + 60;
    analysis.tasks.push_back(task);
  }
  record(analysis, 240);
  const TaskPaths tasks = task_paths(analysis, analysis.path.incisor_m);
  EXPECT_EQ(tasks.left_out, 0U);
  EXPECT_EQ(expect_good(analysis).in_parts, tasks.in_parts);
}

TEST(TaskPaths, AtSixtyHertzHaveAllSamples) {
  Analysis analysis;
  analysis.tasks.emplace_back();
  analysis.tasks[0].end_s = 120;
  record(analysis, 120);
  const TaskPaths tasks = task_paths(analysis, analysis.path.incisor_m);
  ASSERT_EQ(tasks.paths[0].pieces_m.size(), 1U);
  EXPECT_EQ(tasks.paths[0].pieces_m[0].size(), 120U * 60 + 1);
  EXPECT_EQ(what_is_missing(tasks), "");
}

TEST(TaskPaths, SayWhatIsMissing) {
  TaskPaths tasks;
  EXPECT_EQ(what_is_missing(tasks), "");
  // The last has no samples.
  tasks.paths.resize(10);
  for (std::size_t t = 0; t < 9; ++t) tasks.paths[t].pieces_m.resize(1);
  tasks.in_parts = 1;
  EXPECT_EQ(what_is_missing(tasks), "Of 1 task, only parts are drawn.");
  for (std::size_t t = 4; t < 9; ++t) tasks.paths[t].pieces_m.clear();
  tasks.left_out = 5;
  tasks.in_parts = 2;
  EXPECT_EQ(what_is_missing(tasks),
            "Only 4 of 9 tasks are drawn. Of 2 tasks, only parts are drawn.");
}

}  // namespace
}  // namespace condyle::host
