// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "output/gnuplot.h"
#include "readings/readings_files.h"
#include "readings/strokes.h"
#include "recordings/recording_files.h"

namespace condyle::host {
namespace {

constexpr int kMostCycles = 60;

struct Style {
  std::string_view side;
  const char *line, *band;
};
constexpr Style kStyles[] = {{"left", "#1f5fa8", "#9ecae1"},
                             {"right", "#c8641e", "#fdd0a2"},
                             {"midline", "#2e8b57", "#c7e9c0"},
                             {"all", "#1f5fa8", "#9ecae1"}};

// The averages that are known: of the sides, or of all if they are not.
std::vector<const AverageCycle*> drawn_averages(const Analysis& analysis) {
  std::vector<const AverageCycle*> sides, all;
  for (const AverageCycle& average : analysis.average_cycles) {
    if (!average.withheld.empty()) continue;
    (average.side == "all" ? all : sides).push_back(&average);
  }
  return sides.empty() ? all : sides;
}

std::string cycle_paths(const Analysis& analysis) {
  const std::vector<double>& time_s = analysis.path.time_s;
  const double gap_s = longest_drawn_gap_s(time_s);
  std::string text = "$cycles << EOD\n";
  int drawn = 0;
  for (const AnalysedCycle& cycle : analysis.cycles) {
    if (cycle.number == 0 || ++drawn > kMostCycles) continue;
    for (const SampleRun& run :
         runs_without_gap(time_s, {cycle.cycle.begin, cycle.cycle.end + 1}, gap_s)) {
      for (std::size_t k = run.begin; k < run.end; ++k) {
        const Eigen::Vector3d point_mm = 1e3 * analysis.path.incisor_m[k];
        text += fmt::format("{:.4f} {:.4f}\n", point_mm.y(), point_mm.z());
      }
      text += "\n";
    }
  }
  return text + "EOD\n";
}

// Columns: time (s), y, z, half interval of y, of z (mm). Then for each half the outline of the
// band: out along its right side, back along its left.
std::string data_of(const AverageCycle& average, std::size_t number) {
  std::string text = fmt::format("$average{} << EOD\n", number);
  for (const AverageCycle::Point& point : average.points) {
    text += fmt::format("{:.5f} {:.4f} {:.4f} {:.4f} {:.4f}\n", point.time_s, point.mean_mm.y(),
                        point.mean_mm.z(), point.half_interval_mm.y(), point.half_interval_mm.z());
  }
  text += fmt::format("EOD\n$band{} << EOD\n", number);
  for (const bool is_closing : {false, true}) {
    std::string back;
    for (const AverageCycle::Point& point : average.points) {
      if (point.is_closing != is_closing) continue;
      const double y = point.mean_mm.y(), half = point.half_interval_mm.y();
      text += fmt::format("{:.4f} {:.4f}\n", y - half, point.mean_mm.z());
      back.insert(0, fmt::format("{:.4f} {:.4f}\n", y + half, point.mean_mm.z()));
    }
    text += back + "\n\n";
  }
  return text + "EOD\n";
}

}  // namespace

std::string average_cycle_plot(const Analysis& analysis) {
  const std::vector<const AverageCycle*> averages = drawn_averages(analysis);
  if (averages.empty()) return "";
  const bool is_assumed = std::any_of(averages.begin(), averages.end(),
                                      [](const auto* one) { return !one->assumed.empty(); });
  std::string text = cycle_paths(analysis), frontal, bands, lines;
  for (std::size_t i = 0; i < averages.size(); ++i) {
    const AverageCycle& average = *averages[i];
    text += data_of(average, i);
    const Style& style = *std::find_if(std::begin(kStyles), std::end(kStyles),
                                       [&](const Style& one) { return one.side == average.side; });
    const std::string fill =
        fmt::format("fc rgb '{}' fs transparent solid 0.6 noborder notitle", style.band);
    const std::string line = fmt::format("with lines lw 2 lc rgb '{}'", style.line);
    for (int half = 0; half < 2; ++half) {
      frontal +=
          fmt::format(", $band{} index {} using 1:2 with filledcurves closed {}", i, half, fill);
    }
    frontal += fmt::format(", $average{} using 2:3 {} notitle", i, line);
    bands += fmt::format("{}$average{} using 1:($3-$5):($3+$5) with filledcurves {}",
                         i > 0 ? ", " : "", i, fill);
    lines += fmt::format(", $average{} using 1:3 {} title '{}, {} cycles'", i, line, average.side,
                         average.cycles);
  }
  text += fmt::format(
      "set multiplot layout 1,2 title {} font ',13' noenhanced\nset grid lc rgb '#dddddd'\n"
      "set size ratio -1\nset title 'frontal, seen from the front' font ',11'\n"
      "set xlabel 'left (mm)'\nset ylabel 'up (mm)'\nset xrange [*:*] noreverse\nunset key\n"
      "plot $cycles using 1:2 with lines lw 0.6 lc rgb '#c0c0c0' notitle{}\n"
      "set size noratio\nset title 'vertical, mean with 95 % band' font ',11'\n"
      "set xlabel 'time from closed (s)'\nset key outside right top\nplot {}\nunset multiplot\n",
      gnuplot_quoted(fmt::format("Average chewing cycle: {}{}; research use only",
                                 recording_name(analysis.recording),
                                 is_assumed ? "; samples that jump are not used" : "")),
      frontal, bands + lines);
  return text;
}

}  // namespace condyle::host
