// SPDX-License-Identifier: Apache-2.0
#include "output/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "output/gnuplot.h"
#include "output/output_file.h"

namespace condyle::host {
namespace {

// One figure: an estimated quantity, and the values for comparison.
struct Figure {
  const char* name;
  const char* axis_label;
  const char* estimate_label;
  FigureCurve FigureRun::*curve;
  Extremes FigureRun::*comparison;  // null: none
  const char* comparison_label;
  double shown_per_si;  // 1000: mm for m
};

constexpr Figure kFigures[] = {
    {"position", "position (mm)", "position", &FigureRun::position_m,
     &FigureRun::measured_position_m, "measured position", 1000},
    {"velocity", "velocity (mm/s)", "velocity", &FigureRun::velocity_m_s,
     &FigureRun::differentiated_velocity_m_s, "differentiated position", 1000},
    {"force", "net force (N)", "assumed mass x acceleration", &FigureRun::force_N, nullptr, "", 1},
    {"friction", "friction (Ns/m)", "friction", &FigureRun::friction_Ns_m, nullptr, "", 1},
    {"mass", "mass (kg)", "mass", &FigureRun::mass_kg, nullptr, "", 1}};

// Style of a provenance. gnuplot draws one curve for each provenance, with gaps for the others.
struct Style {
  Provenance provenance;
  const char* line;
  const char* band;
  const char* label;
};

constexpr Style kStyles[] = {
    {Provenance::measured, "lc rgb '#0b559f' lw 1.6 dt 1", "fc rgb '#9ecae1' fs solid 0.6 noborder",
     "measured"},
    {Provenance::derived, "lc rgb '#b35900' lw 1.6 dt 1", "fc rgb '#fdd0a2' fs solid 0.6 noborder",
     "derived from an assumption"},
    {Provenance::assumed, "lc rgb '#606060' lw 1.6 dt (8,6)",
     "fc rgb '#b0b0b0' fs pattern 4 noborder", "ASSUMED, not measured"}};

bool is_drawn(const FigureCurve& curve) {
  return !std::isnan(curve.value.lowest);
}

// Columns: time, comparison, value, band from, band to, provenance, event mark. A run that stands
// for several samples gives two rows, its lowest and its highest.
std::string data_block(const Figure& figure, const FigureData& data) {
  std::string block = fmt::format("${} << EOD\n", figure.name);
  for (const FigureRun& run : data.runs()) {
    const FigureCurve& curve = run.*figure.curve;
    const Extremes comparison = figure.comparison != nullptr ? run.*figure.comparison : Extremes{};
    const auto row = [&](double compared, double value) {
      const double scale = figure.shown_per_si;
      block +=
          fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {} {}\n", run.time_s, compared * scale,
                      value * scale, curve.band.lowest * scale, curve.band.highest * scale,
                      static_cast<int>(curve.provenance), run.has_event ? 0.01 : -1);
    };
    row(comparison.lowest, curve.value.lowest);
    if (data.samples_per_run() > 1) row(comparison.highest, curve.value.highest);
  }
  return block + "EOD\n";
}

std::string plot_command(const Figure& figure, const FigureData& data) {
  std::string plot;
  const auto add = [&plot](const std::string& curve) {
    plot += plot.empty() ? "plot " : ", \\\n  ";
    plot += curve;
  };
  const auto for_present_styles = [&](auto&& visit) {
    for (const Style& style : kStyles) {
      const bool present =
          std::any_of(data.runs().begin(), data.runs().end(), [&](const FigureRun& run) {
            const FigureCurve& curve = run.*figure.curve;
            return is_drawn(curve) && curve.provenance == style.provenance;
          });
      if (present) visit(style);
    }
  };
  for_present_styles([&](const Style& style) {
    add(
        fmt::format("${0} using 1:($6=={1}?$4:NaN):($6=={1}?$5:NaN) with filledcurves {2} "
                    "title '{3}'",
                    figure.name, static_cast<int>(style.provenance), style.band,
                    style.provenance == Provenance::assumed
                        ? "95 % band of the filter, if its assumption is right"
                        : "95 % band"));
  });
  if (figure.comparison != nullptr) {
    add(fmt::format("${} using 1:2 with points pt 7 ps 0.25 lc rgb '#303030' title '{}'",
                    figure.name, figure.comparison_label));
  }
  for_present_styles([&](const Style& style) {
    add(fmt::format("${} using 1:($6=={}?$3:NaN) with lines {} title '{}: {}'", figure.name,
                    static_cast<int>(style.provenance), style.line, figure.estimate_label,
                    style.label));
  });
  const bool has_events = std::any_of(data.runs().begin(), data.runs().end(),
                                      [](const FigureRun& run) { return run.has_event; });
  if (has_events) {
    add(
        fmt::format("${} using 1:($7>0?$7:NaN) axes x1y2 with points pt 2 ps 0.5 "
                    "lc rgb '#c00000' title 'event'",
                    figure.name));
  }
  return plot;
}

// The vertical range: that of the measured and derived values if there are any (a prior's band
// would dwarf them), otherwise that of all.
std::string range_command(const Figure& figure, const FigureData& data) {
  Extremes known, all;
  for (const FigureRun& run : data.runs()) {
    const FigureCurve& curve = run.*figure.curve;
    if (!is_drawn(curve)) continue;
    all.add(curve.band);
    if (curve.provenance != Provenance::assumed) known.add(curve.band);
    if (figure.comparison != nullptr) known.add(run.*figure.comparison);
  }
  const Extremes& range = std::isnan(known.lowest) ? all : known;
  const double low = range.lowest * figure.shown_per_si, high = range.highest * figure.shown_per_si;
  const double margin = 0.05 * (high - low);
  if (!std::isfinite(margin) || !(margin > 0)) return "set yrange [*:*]\n";
  return fmt::format("set yrange [{:.9g}:{:.9g}]\n", low - margin, high + margin);
}

// Label above a figure with only assumed values.
std::string label_command(const Figure& figure, const FigureData& data) {
  const bool all_assumed =
      std::all_of(data.runs().begin(), data.runs().end(), [&](const FigureRun& run) {
        return !is_drawn(run.*figure.curve) ||
               (run.*figure.curve).provenance == Provenance::assumed;
      });
  return all_assumed ? "set label 1 'ASSUMED: does not describe the subject' at graph 0.5, 1.035 "
                       "center font ',11' tc rgb '#a00000'\n"
                     : "unset label 1\n";
}

bool has_values(const Figure& figure, const FigureData& data) {
  return std::any_of(data.runs().begin(), data.runs().end(),
                     [&](const FigureRun& run) { return is_drawn(run.*figure.curve); });
}

std::string time_label(const FigureData& data) {
  if (data.origin_ns() == 0) return "time (s)";
  std::string label = "time since the first sample, which is at ";
  append_time_s(label, data.origin_ns());
  return label + " s (s)";
}

// gnuplot warns if all times are the same.
std::string time_range_command(const FigureData& data) {
  Extremes time;
  for (const FigureRun& run : data.runs()) time.add(run.time_s);
  if (time.highest > time.lowest) return "set autoscale xfix\n";
  return fmt::format("set xrange [{:.9g}:{:.9g}]\n", time.lowest - 0.5, time.lowest + 0.5);
}

}  // namespace

std::vector<std::unique_ptr<OutputFile>> draw_figures(const std::string& directory,
                                                      const std::string& title,
                                                      const FigureData& data) {
  Gnuplot gnuplot(directory);
  gnuplot.send(
      "set key outside bottom center maxrows 4 Left reverse samplen 2 font ',9'\n"
      "set y2range [0:1]\nset ytics nomirror\n" +
      fmt::format("set xlabel {}\n", gnuplot_quoted(time_label(data))) + time_range_command(data));
  for (const Figure& figure : kFigures) {
    if (!has_values(figure, data)) continue;
    gnuplot.send(data_block(figure, data));
    gnuplot.send(fmt::format("set ylabel '{}'\n", figure.axis_label) +
                 title_command(title, "offset 0,0.8 font ',11'"));
    gnuplot.send(range_command(figure, data) + label_command(figure, data));
    gnuplot.draw(figure.name, plot_command(figure, data), 960, 480);
  }
  return gnuplot.finish();
}

}  // namespace condyle::host
