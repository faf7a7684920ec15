// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparison/comparison_text.h"
#include "comparison/figure_label.h"
#include "output/gnuplot.h"
#include "recordings/recording_files.h"

namespace condyle::host {
namespace {

constexpr int kWidth = 1200, kFoot = 58, kLeastRows = 110;
constexpr double kLeft = 0.19, kRight = 0.985, kGap = 0.025;  // of the panels, in the figure
constexpr std::size_t kLongestRecording = 30, kLongestEstimator = 60;

struct Panel {
  const char* label;
  bool is_logarithmic;
  bool shows_first;  // otherwise the baseline is left out
  double (*value)(const RunReport&);
  Interval (*interval)(const RunReport&);  // of the value; null: none
};

double sure_difference(const RunReport& run) {
  const BlockMean& difference = run.score_difference;
  return difference.blocks > 0 ? difference.mean : EstimateRow::kNone;
}

// Those that show the first estimator come first.
const Panel kPanels[] = {
    {"prediction error, rms (mm)", false, true,
     [](const RunReport& run) { return 1e3 * run.error_rms_m; }, nullptr},
    {"mean NIS; grey: 95 % if right", true, true, [](const RunReport& run) { return run.mean_nis; },
     nullptr},
    {"log score against the first, 95 %", false, false, sure_difference,
     [](const RunReport& run) { return run.score_difference.interval; }},
    {"velocity against the first, rms (mm/s)", false, false,
     [](const RunReport& run) { return 1e3 * run.velocity_difference_m_s; }, nullptr},
};

// What is drawn: recordings from the top, estimators within each.
struct Drawing {
  const std::vector<RecordingReport>& recordings;
  std::size_t drawn, estimators;

  // Where an estimator's point stands; the row of a recording is 1 high.
  double row(std::size_t recording, std::size_t estimator) const {
    const auto count = static_cast<double>(estimators);
    const double place = (static_cast<double>(estimator) + 0.5) / count - 0.5;
    return static_cast<double>(recording) + 0.6 * place;
  }
};

std::string number_or_gap(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : "NaN";
}

// Rows "row value low high" of an estimator in a panel; low and high: of the value, or for NIS its
// expected range.
std::string panel_data(const Drawing& drawing, std::size_t k, std::size_t estimator,
                       Extremes& all) {
  const Panel& panel = kPanels[k];
  std::string block = fmt::format("$panel{}of{} << EOD\n", k, estimator);
  for (std::size_t i = 0; i < drawing.drawn; ++i) {
    const RunReport& run = drawing.recordings[i].runs[estimator];
    double value = panel.value(run);
    if (panel.is_logarithmic && !(value > 0)) value = EstimateRow::kNone;
    const bool is_shown = panel.shows_first || estimator > 0;
    Interval interval{value, value};
    if (panel.interval != nullptr && std::isfinite(value)) interval = panel.interval(run);
    if (panel.is_logarithmic) interval = run.nis_bounds;
    if (panel.is_logarithmic && !(interval.low > 0)) {
      interval = {EstimateRow::kNone, EstimateRow::kNone};
    }
    if (std::isfinite(value) && is_shown) {
      all.add(value);
      all.add(interval.low);
      all.add(interval.high);
    }
    block += fmt::format("{:.4f} {} {} {}\n", drawing.row(i, estimator), number_or_gap(value),
                         number_or_gap(interval.low), number_or_gap(interval.high));
  }
  return block + "EOD\n";
}

// Range and about five tics.
std::string axis_text(const Panel& panel, Extremes all) {
  if (panel.is_logarithmic) {
    all.add(0.5);
    all.add(2);
    return fmt::format(
        "set logscale x\nset xrange [{:.6g}:{:.6g}]\nset xtics (0.001, 0.01, 0.1, 0.2, 0.5, 1, 2, "
        "5, 10, 100, 1000)\nset arrow 1 from 1, graph 0 to 1, graph 1 nohead back lc rgb "
        "'#909090'\n",
        all.lowest / 1.3, all.highest * 1.3);
  }
  all.add(0);
  const double span = all.highest - all.lowest;
  if (!(span > 0)) {
    return "unset logscale x\nset xrange [-1:1]\nset xtics (0)\nunset arrow\n";
  }
  const double decade = std::pow(10, std::floor(std::log10(span)));
  const double step = decade * (span / decade > 5 ? 2 : span / decade > 2.5 ? 1 : 0.5);
  return fmt::format(
      "unset logscale x\nset xrange [{:.6g}:{:.6g}]\nset xtics {:.6g}\n"
      "set arrow 1 from 0, graph 0 to 0, graph 1 nohead back lc rgb '#909090'\n",
      all.lowest < 0 ? all.lowest - 0.06 * span : 0.0,
      all.highest > 0 ? all.highest + 0.06 * span : 0.06 * span, step);
}

std::string curves_text(const Drawing& drawing, std::size_t k) {
  const Panel& panel = kPanels[k];
  std::string curves;
  const auto add = [&curves](const std::string& curve) {
    curves += (curves.empty() ? "plot " : ", ") + curve;
  };
  const std::size_t first = panel.shows_first ? 0 : 1;
  const double half_height = 0.16 / static_cast<double>(drawing.estimators);
  for (std::size_t i = first; i < drawing.estimators && panel.is_logarithmic; ++i) {
    add(
        fmt::format("$panel{}of{} using 3:1:3:4:($1-{:.4f}):($1+{:.4f}) with boxxyerror fs solid "
                    "noborder lc rgb '#c8c8c8' notitle",
                    k, i, half_height, half_height));
  }
  for (std::size_t i = first; i < drawing.estimators; ++i) {
    const char* const colour = kSeriesColours[i % kSeriesColourCount];
    add(fmt::format("$panel{}of{} using 2:1 with points pt 7 ps 0.8 lc rgb '{}' notitle", k, i,
                    colour));
    if (panel.interval == nullptr) continue;
    add(
        fmt::format("$panel{}of{} using 2:1:3:4 with xerrorbars pt 7 ps 0.8 lw 1.4 lc rgb '{}' "
                    "notitle",
                    k, i, colour));
  }
  return curves.empty() ? "plot NaN notitle\n" : curves + "\n";
}

std::string legend_text(const std::vector<NamedEstimator>& estimators, int height) {
  std::string text;
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    const char* const colour = kSeriesColours[i % kSeriesColourCount];
    text += fmt::format(
        "set label {} {} at screen {:.5f}, screen {:.5f} left noenhanced font ',10' textcolor rgb "
        "'{}' point pt 7 ps 0.8 lc rgb '{}' offset 1,0\n",
        10 + i, gnuplot_quoted(figure_label(estimators[i].name, kLongestEstimator)),
        i % 2 == 0 ? kLeft : (kLeft + kRight + kGap) / 2,
        1 - (42.0 + 20 * static_cast<double>(i / 2)) / height, colour, colour);
  }
  return text;
}

}  // namespace

std::vector<std::unique_ptr<OutputFile>> draw_comparison(
    const std::string& directory, const std::vector<NamedEstimator>& estimators,
    const std::vector<RecordingReport>& recordings) {
  const Drawing drawing{recordings, std::min(recordings.size(), kMostDrawn), estimators.size()};
  std::string names, no_names;
  for (std::size_t i = 0; i < drawing.drawn; ++i) {
    const std::string file = recording_name(recordings[i].source);
    const char* const comma = i > 0 ? ", " : "";
    names +=
        fmt::format("{}{} {}", comma, gnuplot_quoted(figure_label(file, kLongestRecording)), i);
    no_names += fmt::format("{}'' {}", comma, i);
  }
  const int head = 44 + 20 * (static_cast<int>(estimators.size()) + 1) / 2;
  const int row_height = 12 + 9 * static_cast<int>(estimators.size());
  const int rows = std::max(kLeastRows, row_height * static_cast<int>(drawing.drawn));
  const int height = head + rows + kFoot;
  std::string title = "Estimators on the same recordings";
  if (drawing.drawn < recordings.size()) {
    title += fmt::format(", the first {} of {}", drawing.drawn, recordings.size());
  }
  std::string plot = fmt::format(
      "set multiplot\nset tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n"
      "set yrange [{}:-0.5]\nset ytics ({}) noenhanced font ',9'\n"
      "set xtics nomirror font ',9'\nset grid noytics\n"
      "set label 1 {} at screen 0.5, screen {:.5f} center noenhanced font ',12'\n",
      1 - static_cast<double>(head) / height, static_cast<double>(kFoot) / height,
      static_cast<double>(drawing.drawn) - 0.5, names,
      gnuplot_quoted(title + "  (research use only)"), 1 - 16.0 / height);
  plot += legend_text(estimators, height);

  Gnuplot gnuplot(directory);
  // A single estimator has no baseline.
  const auto panels = static_cast<std::size_t>(std::count_if(
      std::begin(kPanels), std::end(kPanels),
      [&](const Panel& panel) { return panel.shows_first || estimators.size() > 1; }));
  const auto panel_count = static_cast<double>(panels);
  const double width = (kRight - kLeft - (panel_count - 1) * kGap) / panel_count;
  for (std::size_t k = 0; k < panels; ++k) {
    Extremes all;
    for (std::size_t i = 0; i < estimators.size(); ++i) {
      gnuplot.send(panel_data(drawing, k, i, all));
    }
    const double left = kLeft + static_cast<double>(k) * (width + kGap);
    plot += fmt::format("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n{}", left,
                        left + width, axis_text(kPanels[k], all));
    plot += fmt::format("set xlabel '{}' font ',10'\n", kPanels[k].label) + curves_text(drawing, k);
    if (k == 0) plot += fmt::format("set ytics ({})\nunset label\n", no_names);
  }
  gnuplot.draw("estimators", plot + "unset multiplot\nunset arrow\n", kWidth, height);
  return gnuplot.finish();
}

}  // namespace condyle::host
