// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "output/gnuplot.h"
#include "readings/readings_files.h"
#include "readings/strokes.h"
#include "recordings/recording_files.h"

namespace condyle::host {
namespace {

constexpr const char* kColours[kTaskKinds + 1] = {"0x1f5fa8", "0xc8641e", "0x2e8b57", "0x8a4fa3",
                                                  "0x505050", "0xb03060", "0xc0a000", "0x1f5fa8"};
// Of a long task, stretches of its path are drawn. Of a recording at 100 Hz, all samples.
constexpr double kPointStep_s = 0.009, kStretch_s = 2;
constexpr double kMostPoints = 10'000;

// Least and greatest of numbers.
struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double number) {
    low = std::min(low, number);
    high = std::max(high, number);
  }
  // In gnuplot's syntax, at least 1 mm wide; autoscaled if there are no numbers.
  std::string text(bool is_mirrored) const {
    constexpr double kMargin = 0.05, kLeast_mm = 1;
    if (!(low <= high)) return is_mirrored ? "[*:*] reverse" : "[*:*] noreverse";
    const double half = std::max((0.5 + kMargin) * (high - low), kLeast_mm / 2);
    const double first = (low + high) / 2 - half, last = (low + high) / 2 + half;
    return fmt::format("[{:.4f}:{:.4f}]", is_mirrored ? last : first, is_mirrored ? first : last);
  }
};

// What is drawn of the tasks of one kind. Rows: incisor x y z, left condyle x y z, right condyle x
// y z (mm).
struct DrawnTask {
  TaskKind kind;
  std::size_t share = 1;  // one of so many stretches
  std::string lines;      // rows of the pieces of the path
  std::string dots;       // rows of samples: of pieces that a panel hides as a line
};

struct DrawnData {
  bool has_condyles = false;
  std::vector<DrawnTask> tasks;
  Range incisor_mm[3], condyles_x_mm, condyles_z_mm;
};

using Row = std::array<double, 9>;

Row row_of(const JawPath& path, std::size_t k) {
  Row row_mm;
  auto next = row_mm.begin();
  for (const auto* place : {&path.incisor_m, &path.condyle_m[0], &path.condyle_m[1]}) {
    for (const double value : (*place)[k]) *next++ = value * 1e3;
  }
  return row_mm;
}

std::string text_of(const Row& row_mm) {
  return fmt::format("{:.4f}\n", fmt::join(row_mm, " "));
}

// Whether a line of these extents (mm) is seen in every panel.
bool is_seen(const std::array<Range, 9>& extents, bool has_condyles) {
  constexpr double kLeast_mm = 0.05;
  constexpr std::pair<std::size_t, std::size_t> kPanels[] = {
      {0, 2}, {1, 2}, {0, 1}, {3, 5}, {6, 8}};
  const auto width = [&](std::size_t column) { return extents[column].high - extents[column].low; };
  return std::all_of(kPanels, kPanels + (has_condyles ? 5 : 3), [&](const auto& panel) {
    return std::max(width(panel.first), width(panel.second)) >= kLeast_mm;
  });
}

// Adds the samples of a piece without gaps in a task that begins at `begin_s`.
void add_piece(const JawPath& path, SampleRun piece, double begin_s, DrawnTask& task,
               DrawnData& data) {
  std::string rows, first;
  std::array<Range, 9> extents;
  double drawn_s = 0;
  const auto end_line = [&] {
    if (rows.empty()) return;
    task.lines += rows + "\n";
    if (!is_seen(extents, data.has_condyles)) task.dots += first;
    rows.clear();
    extents = {};
  };
  for (std::size_t k = piece.begin; k < piece.end; ++k) {
    const double time_s = path.time_s[k];
    if (static_cast<std::size_t>((time_s - begin_s) / kStretch_s) % task.share != 0) {
      end_line();
      continue;
    }
    const bool is_last = k + 1 == piece.end;
    if (!rows.empty() && !is_last && time_s - drawn_s < kPointStep_s) continue;
    const Row row_mm = row_of(path, k);
    if (rows.empty()) first = text_of(row_mm);
    rows += text_of(row_mm);
    drawn_s = time_s;
    for (std::size_t i = 0; i < row_mm.size(); ++i) extents[i].add(row_mm[i]);
    for (std::size_t i = 0; i < 3; ++i) data.incisor_mm[i].add(row_mm[i]);
    for (const std::size_t i : {3U, 6U}) {
      data.condyles_x_mm.add(row_mm[i]);
      data.condyles_z_mm.add(row_mm[i + 2]);
    }
  }
  end_line();
}

DrawnData data_of(const Analysis& analysis) {
  DrawnData data;
  data.has_condyles = analysis.has_landmarks;
  const JawPath& path = analysis.path;
  const std::vector<double>& time_s = path.time_s;
  if (time_s.size() < 2) return data;
  const double gap_s = longest_drawn_gap_s(time_s);
  for (std::size_t i = 0; i <= kTaskKinds; ++i) {
    DrawnTask task{static_cast<TaskKind>(i), 1, {}, {}};
    std::vector<SampleRun> runs;
    double points = 0;
    for (const Task& one : analysis.tasks) {
      if (one.kind != task.kind) continue;
      const SampleRun run = samples_of(one, time_s);
      if (run.begin >= run.end) continue;
      runs.push_back(run);
      points += std::min(static_cast<double>(run.end - run.begin),
                         (time_s[run.end - 1] - time_s[run.begin]) / kPointStep_s);
    }
    task.share = 1 + static_cast<std::size_t>(points / kMostPoints);
    for (const SampleRun& run : runs) {
      for (const SampleRun& piece : runs_without_gap(time_s, run, gap_s)) {
        add_piece(path, piece, time_s[run.begin], task, data);
      }
    }
    if (!runs.empty()) data.tasks.push_back(std::move(task));
  }
  return data;
}

// As blocks of data that the plots name.
std::string blocks_of(const std::vector<DrawnTask>& tasks) {
  std::string text;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    text += fmt::format("$lines{0} << EOD\n{1}EOD\n$dots{0} << EOD\n{2}EOD\n", i, tasks[i].lines,
                        tasks[i].dots);
  }
  return text;
}

std::string title_of(const DrawnTask& task) {
  const char* const name = name_of(task.kind);
  const std::string title = *name != 0 ? name : "recording";
  if (task.share == 1) return title;
  return fmt::format("{} ({:g} of {:g} s)", title, kStretch_s,
                     kStretch_s * static_cast<double>(task.share));
}

// What the next figure does not set itself.
constexpr const char* kEndOfPanels = "unset multiplot\nset yrange [*:*]\nset rmargin\n";

struct Plane {
  const char *title, *x_label, *y_label;
  int x, y;          // columns
  bool is_mirrored;  // the x axis grows to the left
  Range x_range = {}, y_range = {};
};

std::string panel(const Plane& plane, const std::vector<DrawnTask>& drawn, bool has_key) {
  std::string text = fmt::format(
      "set title '{}' font ',11'\nset xlabel '{}'\nset ylabel '{}'\nset xrange {}\nset yrange "
      "{}\n{}\nplot ",
      plane.title, plane.x_label, plane.y_label, plane.x_range.text(plane.is_mirrored),
      plane.y_range.text(false), has_key ? "set key outside right top" : "unset key");
  // A colour from a column: a line of one colour takes time with the square of its points.
  std::string separator;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const DrawnTask& task = drawn[i];
    const char* const colour = kColours[static_cast<std::size_t>(task.kind)];
    for (const bool is_dot : {false, true}) {
      if ((is_dot ? task.dots : task.lines).empty()) continue;
      text += fmt::format("{}${}{} using {}:{}:({}) with {} lc rgb variable notitle", separator,
                          is_dot ? "dots" : "lines", i, plane.x, plane.y, colour,
                          is_dot ? "points pt 7 ps 0.3" : "lines lw 1.2");
      separator = ", ";
    }
  }
  for (const DrawnTask& task : drawn) {
    if (!has_key) break;
    text += fmt::format(", keyentry with lines lw 1.2 lc rgb {} title '{}'",
                        kColours[static_cast<std::size_t>(task.kind)], title_of(task));
  }
  return text + "\n";
}

std::string layout(const std::string& title, std::size_t panels) {
  return fmt::format(
      "set multiplot layout 1,{} title {} font ',13' noenhanced\nset size ratio -1\nset grid lc "
      "rgb "
      "'#dddddd'\n",
      panels, gnuplot_quoted(title + "; research use only"));
}

}  // namespace

std::vector<std::unique_ptr<OutputFile>> draw_readings(const std::string& directory,
                                                       const std::string& prefix,
                                                       const Analysis& analysis) {
  const DrawnData data = data_of(analysis);
  const std::vector<DrawnTask>& drawn = data.tasks;
  if (drawn.empty() || !analysis.unusable.empty()) return {};
  Gnuplot gnuplot(directory);
  gnuplot.send(blocks_of(drawn));
  const bool named = analysis.has_landmarks;
  const std::string what = named ? "Lower incisor" : "Point 1, instrument's axes";
  std::string plot = layout(fmt::format("{}: {}", what, recording_name(analysis.recording)), 3);
  const Range &x = data.incisor_mm[0], &y = data.incisor_mm[1], &z = data.incisor_mm[2];
  const Plane planes[] = {
      {named ? "sagittal, seen from the right" : "x, z", named ? "anterior (mm)" : "x (mm)",
       named ? "up (mm)" : "z (mm)", 1, 3, false, x, z},
      {named ? "frontal, seen from the front" : "y, z", named ? "left (mm)" : "y (mm)",
       named ? "up (mm)" : "z (mm)", 2, 3, false, y, z},
      {named ? "horizontal, seen from below" : "x, y", named ? "left (mm)" : "y (mm)",
       named ? "anterior (mm)" : "x (mm)", 2, 1, false, y, x}};
  for (const Plane& plane : planes) plot += panel(plane, drawn, &plane == &planes[2]);
  plot += kEndOfPanels;
  gnuplot.draw(prefix + "incisor", plot, 1400, 560);
  if (named) {
    plot = layout(fmt::format("Condyles, sagittal: {}", recording_name(analysis.recording)), 2);
    // Equal ranges, so that lengths compare between the sides.
    const Range &across = data.condyles_x_mm, &up = data.condyles_z_mm;
    const Plane right = {
        "right, anterior to the right", "anterior (mm)", "up (mm)", 7, 9, false, across, up};
    const Plane left = {
        "left, anterior to the left", "anterior (mm)", "up (mm)", 4, 6, true, across, up};
    // Room for the key beside both, or the panel without it would be larger.
    std::size_t key_width = 0;
    for (const DrawnTask& task : drawn) key_width = std::max(key_width, title_of(task).size());
    plot += fmt::format("set rmargin {}\n", key_width + 8);
    plot += panel(right, drawn, false) + panel(left, drawn, true);
    plot += kEndOfPanels;
    gnuplot.draw(prefix + "condyles", plot, 1200, 560);
  }
  plot = average_cycle_plot(analysis);
  if (!plot.empty()) gnuplot.draw(prefix + "average_cycle", plot, 1100, 560);
  return gnuplot.finish();
}

}  // namespace condyle::host
