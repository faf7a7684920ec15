// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "output/gnuplot.h"
#include "readings/readings_files.h"
#include "readings/strokes.h"
#include "recordings/recording_files.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr const char* kColours[kTaskKinds + 1] = {"0x1f5fa8", "0xc8641e", "0x2e8b57", "0x8a4fa3",
                                                  "0x505050", "0xb03060", "0xc0a000", "0x1f5fa8"};
// Of a long task, stretches of its path are drawn.
constexpr double kPointStep_s = 0.01, kStretch_s = 2;
constexpr std::size_t kMostPoints = 10'000;

// What is drawn of the tasks of one kind.
struct DrawnTask {
  TaskKind kind;
  std::size_t share = 1;  // one of so many stretches
};

// Least and greatest of numbers.
struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double number) {
    low = std::min(low, number);
    high = std::max(high, number);
  }
  // As gnuplot takes it; of no numbers: its own choice.
  std::string text(bool is_mirrored) const {
    constexpr double kMargin = 0.05;
    if (!(low < high)) return is_mirrored ? "[*:*] reverse" : "[*:*] noreverse";
    const double margin = kMargin * (high - low);
    const double first = low - margin, last = high + margin;
    return fmt::format("[{:.3f}:{:.3f}]", is_mirrored ? last : first, is_mirrored ? first : last);
  }
};

// What is drawn, as blocks of data: for each kind of task incisor x y z, left condyle x y z, right
// condyle x y z (mm).
struct DrawnData {
  std::string text;
  std::vector<DrawnTask> tasks;
  Range condyles_x_mm, condyles_z_mm;
};

DrawnData data_of(const Analysis& analysis) {
  DrawnData data;
  const JawPath& path = analysis.path;
  if (path.time_s.size() < 2) return data;
  const double step_s =
      (path.time_s.back() - path.time_s.front()) / static_cast<double>(path.time_s.size() - 1);
  const double gap_s = longest_drawn_gap_s(path.time_s);
  const auto stride = static_cast<std::size_t>(std::max(1.0, kPointStep_s / step_s));
  const auto samples = static_cast<std::size_t>(std::max(1.0, kStretch_s / step_s));
  for (std::size_t i = 0; i <= kTaskKinds; ++i) {
    DrawnTask one{.kind = static_cast<TaskKind>(i)};
    std::vector<SampleRun> runs;
    std::size_t points = 0;
    for (const Task& task : analysis.tasks) {
      if (task.kind != one.kind) continue;
      const auto begin = std::lower_bound(path.time_s.begin(), path.time_s.end(), task.begin_s);
      const auto end = std::upper_bound(begin, path.time_s.end(), task.end_s);
      runs.push_back({static_cast<std::size_t>(begin - path.time_s.begin()),
                      static_cast<std::size_t>(end - path.time_s.begin())});
      points += (runs.back().end - runs.back().begin) / stride;
    }
    if (runs.empty()) continue;
    one.share = 1 + points / kMostPoints;
    std::string block;
    for (const SampleRun& run : runs) {
      std::size_t last = run.begin;  // drawn, or passed over
      for (std::size_t k = run.begin; k < run.end; last = k, k += stride) {
        if (longest_gap_s(path.time_s, last, k + 1) > gap_s && !block.ends_with("\n\n")) {
          block += "\n";
        }
        const std::size_t stretch = (k - run.begin) / samples;
        if (stretch % one.share != 0) {
          // The next line begins with the next stretch that is drawn.
          if (block.ends_with("\n\n")) continue;
          block += "\n";
          continue;
        }
        for (const auto* place : {&path.incisor_m, &path.condyle_m[0], &path.condyle_m[1]}) {
          for (const double value : (*place)[k]) {
            fmt::format_to(std::back_inserter(block), "{:.4f} ", value * 1e3);
          }
        }
        block += "\n";
        for (const Points& condyle_m : path.condyle_m) {
          data.condyles_x_mm.add(condyle_m[k].x() * 1e3);
          data.condyles_z_mm.add(condyle_m[k].z() * 1e3);
        }
      }
      block += "\n";
    }
    data.text += fmt::format("$task{} << EOD\n{}EOD\n", data.tasks.size(), block);
    data.tasks.push_back(one);
  }
  return data;
}

std::string title_of(const DrawnTask& task) {
  const char* const name = name_of(task.kind);
  const std::string title = *name != 0 ? name : "recording";
  if (task.share == 1) return title;
  return fmt::format("{} ({:g} of {:g} s)", title, kStretch_s,
                     kStretch_s * static_cast<double>(task.share));
}

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
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    text += fmt::format("{}$task{} using {}:{}:({}) with lines lw 1.2 lc rgb variable notitle",
                        i > 0 ? ", " : "", i, plane.x, plane.y,
                        kColours[static_cast<std::size_t>(drawn[i].kind)]);
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

double longest_drawn_gap_s(const std::vector<double>& time_s) {
  constexpr double kMostSteps = 3;
  std::vector<double> steps_s;
  for (std::size_t k = 1; k < time_s.size(); ++k) steps_s.push_back(time_s[k] - time_s[k - 1]);
  return steps_s.empty() ? 0 : kMostSteps * upper_median(std::move(steps_s));
}

std::vector<std::unique_ptr<OutputFile>> draw_readings(const std::string& directory,
                                                       const std::string& prefix,
                                                       const Analysis& analysis) {
  const DrawnData data = data_of(analysis);
  const std::vector<DrawnTask>& drawn = data.tasks;
  if (drawn.empty() || !analysis.unusable.empty()) return {};
  Gnuplot gnuplot(directory);
  gnuplot.send(data.text);
  const bool named = analysis.has_landmarks;
  const std::string what = named ? "Lower incisor" : "Point 1, instrument's axes";
  std::string plot = layout(fmt::format("{}: {}", what, recording_name(analysis.recording)), 3);
  const Plane planes[] = {
      {named ? "sagittal, seen from the right" : "x, z", named ? "anterior (mm)" : "x (mm)",
       named ? "up (mm)" : "z (mm)", 1, 3, false},
      {named ? "frontal, seen from the front" : "y, z", named ? "left (mm)" : "y (mm)",
       named ? "up (mm)" : "z (mm)", 2, 3, false},
      {named ? "horizontal, seen from below" : "x, y", named ? "left (mm)" : "y (mm)",
       named ? "anterior (mm)" : "x (mm)", 2, 1, false}};
  for (const Plane& plane : planes) plot += panel(plane, drawn, &plane == &planes[2]);
  plot += "unset multiplot\n";
  gnuplot.draw(prefix + "incisor", plot, 1400, 560);
  if (named) {
    plot = layout(fmt::format("Condyles, sagittal: {}", recording_name(analysis.recording)), 2);
    // Equal ranges, so that lengths compare between the sides.
    const Range &x = data.condyles_x_mm, &z = data.condyles_z_mm;
    const Plane right = {
        "right, anterior to the right", "anterior (mm)", "up (mm)", 7, 9, false, x, z};
    const Plane left = {"left, anterior to the left", "anterior (mm)", "up (mm)", 4, 6, true, x, z};
    plot += panel(right, drawn, false) + panel(left, drawn, true);
    plot += "unset multiplot\n";
    gnuplot.draw(prefix + "condyles", plot, 1200, 560);
  }
  plot = average_cycle_plot(analysis);
  if (!plot.empty()) gnuplot.draw(prefix + "average_cycle", plot, 1100, 560);
  return gnuplot.finish();
}

}  // namespace condyle::host
