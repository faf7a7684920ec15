// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/gnuplot.h"
#include "readings/readings_files.h"
#include "recordings/recording_files.h"

namespace condyle::host {
namespace {

constexpr const char* kColours[kTaskKinds + 1] = {"#1f5fa8", "#c8641e", "#2e8b57", "#8a4fa3",
                                                  "#505050", "#b03060", "#c0a000", "#1f5fa8"};
constexpr std::size_t kMostPoints = 20'000;
// To draw one line takes time with the square of its points where it crosses itself.
constexpr std::size_t kLinePoints = 100;

// Blocks of data, one for each task: incisor x y z, left condyle x y z, right condyle x y z (mm).
std::string data_of(const Analysis& analysis, std::vector<TaskKind>& kinds) {
  const JawPath& path = analysis.path;
  const std::size_t stride = 1 + path.time_s.size() / kMostPoints;
  std::string text;
  for (std::size_t i = 0; i <= kTaskKinds; ++i) {
    const auto kind = static_cast<TaskKind>(i);
    std::string block;
    for (const Task& task : analysis.tasks) {
      if (task.kind != kind) continue;
      std::size_t points_of_line = 0;
      std::string row;
      for (std::size_t k = 0; k < path.time_s.size(); k += stride) {
        if (path.time_s[k] < task.begin_s || path.time_s[k] > task.end_s) continue;
        if (++points_of_line > kLinePoints) {
          block += "\n" + row;  // the next line begins where this one ends
          points_of_line = 1;
        }
        row.clear();
        for (const auto* points : {&path.incisor_m, &path.condyle_m[0], &path.condyle_m[1]}) {
          for (const double value : (*points)[k]) row += fmt::format("{:.4f} ", value * 1e3);
        }
        block += row += "\n";
      }
      block += "\n";
    }
    if (block.empty()) continue;
    text += fmt::format("$task{} << EOD\n{}EOD\n", kinds.size(), block);
    kinds.push_back(kind);
  }
  return text;
}

struct Plane {
  const char *title, *x_label, *y_label;
  int x, y;          // columns
  bool is_mirrored;  // the x axis grows to the left
};

std::string panel(const Plane& plane, const std::vector<TaskKind>& kinds, bool has_key) {
  std::string text = fmt::format(
      "set title '{}' font ',11'\nset xlabel '{}'\nset ylabel '{}'\nset xrange [*:*] {}\n{}\nplot ",
      plane.title, plane.x_label, plane.y_label, plane.is_mirrored ? "reverse" : "noreverse",
      has_key ? "set key outside right top" : "unset key");
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const char* const name = name_of(kinds[i]);
    text +=
        fmt::format("{}$task{} using {}:{} with lines lw 1.2 lc rgb '{}' title '{}'",
                    i > 0 ? ", " : "", i, plane.x, plane.y,
                    kColours[static_cast<std::size_t>(kinds[i])], *name != 0 ? name : "recording");
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
  std::vector<TaskKind> kinds;
  const std::string data = data_of(analysis, kinds);
  if (kinds.empty() || !analysis.unusable.empty()) return {};
  Gnuplot gnuplot(directory);
  gnuplot.send(data);
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
  for (const Plane& plane : planes) plot += panel(plane, kinds, &plane == &planes[2]);
  plot += "unset multiplot\n";
  gnuplot.draw(prefix + "incisor", plot, 1400, 560);
  if (named) {
    plot = layout(fmt::format("Condyles, sagittal: {}", recording_name(analysis.recording)), 2);
    plot += panel({"right, anterior to the right", "anterior (mm)", "up (mm)", 7, 9, false}, kinds,
                  false);
    plot +=
        panel({"left, anterior to the left", "anterior (mm)", "up (mm)", 4, 6, true}, kinds, true);
    plot += "unset multiplot\n";
    gnuplot.draw(prefix + "condyles", plot, 1200, 560);
  }
  plot = average_cycle_plot(analysis);
  if (!plot.empty()) gnuplot.draw(prefix + "average_cycle", plot, 1100, 560);
  return gnuplot.finish();
}

}  // namespace condyle::host
