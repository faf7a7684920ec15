// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparison/figure_label.h"
#include "comparison/session_text.h"
#include "output/gnuplot.h"

namespace condyle::host {
namespace {

constexpr int kPanelWidth = 400, kPanelHeight = 300, kHead = 64;
constexpr std::size_t kMostColumns = 3;

// Widths; sessions are 1 apart.
constexpr double kRepeatSpread = 0.24, kMeanHalfWidth = 0.2;

std::string blocks_of(const QuantityComparison& quantity, std::size_t index) {
  std::string repeats = fmt::format("$repeats{} << EOD\n", index);
  std::string means = fmt::format("$means{} << EOD\n", index);
  std::string bars = fmt::format("$bars{} << EOD\nNaN NaN NaN\n", index);
  for (std::size_t i = 0; i < quantity.values.size(); ++i) {
    const std::vector<double>& values = quantity.values[i];
    const auto x = static_cast<double>(i);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double share =
          values.size() > 1 ? static_cast<double>(k) / static_cast<double>(values.size() - 1) - 0.5
                            : 0;
      repeats += fmt::format("{:.4f} {:.9g}\n", x + kRepeatSpread * share, values[k]);
    }
    means += fmt::format("{:.4f} {:.9g} {}\n", x, quantity.means[i], kMeanHalfWidth);
  }
  for (const SessionChange& change : quantity.changes) {
    if (change.from != 0 || !std::isfinite(change.smallest)) continue;
    bars += fmt::format("{:.4f} {:.9g} {:.9g}\n", static_cast<double>(change.to), quantity.means[0],
                        change.smallest);
  }
  return repeats + "EOD\n" + means + "EOD\n" + bars + "EOD\n";
}

}  // namespace

std::vector<std::unique_ptr<OutputFile>> draw_sessions(const std::string& directory,
                                                       const std::string& estimator,
                                                       const std::vector<Session>& sessions,
                                                       const SessionComparison& comparison) {
  std::vector<const QuantityComparison*> shown;
  for (const QuantityComparison& quantity : comparison.quantities) {
    if (quantity.withheld.empty()) shown.push_back(&quantity);
  }
  if (shown.empty()) return {};
  Gnuplot gnuplot(directory);
  for (std::size_t i = 0; i < shown.size(); ++i) gnuplot.send(blocks_of(*shown[i], i));

  const std::size_t columns = std::min(shown.size(), kMostColumns);
  const std::size_t lines = (shown.size() + columns - 1) / columns;
  const int width = kPanelWidth * static_cast<int>(std::max<std::size_t>(columns, 2));
  const int height = kPanelHeight * static_cast<int>(lines) + kHead;
  // Labels that would overlap are shortened; many sessions have numbers as labels.
  const std::size_t longest = std::max<std::size_t>(4, 48 / sessions.size());
  std::string names;
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    const std::string name =
        sessions.size() > 8 ? std::to_string(i + 1) : figure_label(sessions[i].name, longest);
    names += fmt::format("{}{} {}", i > 0 ? ", " : "", gnuplot_quoted(name), i);
  }
  std::string plot = fmt::format(
      "set multiplot\nset xrange [-0.6:{}]\nset xtics ({}) noenhanced nomirror font ',9'\n"
      "set ytics font ',9'\nset lmargin 10\nset rmargin 2\nset offsets 0, 0, graph 0.06, graph "
      "0.06\nset grid noxtics\n"
      "set label 1 {} at screen 0.5, screen {:.5f} center noenhanced font ',12'\n"
      "set label 2 {} at screen 0.5, screen {:.5f} center noenhanced font ',10'\n",
      static_cast<double>(sessions.size()) - 0.4, names,
      gnuplot_quoted("Sessions of one subject, " + figure_label(estimator, 48) +
                     "  (research use only)"),
      1 - 17.0 / height,
      gnuplot_quoted("points: recordings; line: mean; grey: within it, a mean does not differ "
                     "detectably from the first session's (95 %)"),
      1 - 41.0 / height);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const QuantityComparison& quantity = *shown[i];
    const double panel_width = 1.0 / static_cast<double>(std::max<std::size_t>(columns, 2));
    const double panel_height = static_cast<double>(kPanelHeight) / height;
    const double x = static_cast<double>(i % columns) * panel_width;
    const double y = 1 - static_cast<double>(kHead) / height -
                     static_cast<double>(i / columns + 1) * panel_height;
    plot += fmt::format(
        "set origin {0:.5f},{1:.5f}\nset size {2:.5f},{3:.5f}\nset title {5} noenhanced font "
        "',10'\n"
        "set ylabel {6} noenhanced font ',10'\n"
        "plot $bars{4} using 1:2:(0.38):3 with boxxyerror fs solid noborder lc rgb '#dcdcdc' "
        "notitle, $means{4} using ($1-$3):2:(2*$3):(0) with vectors nohead lw 2.4 lc rgb '#b35900' "
        "notitle, $repeats{4} using 1:2 with points pt 7 ps 0.7 lc rgb '#0b559f' notitle\n",
        x, y, panel_width, panel_height, i,
        gnuplot_quoted(quantity.repeats.is_known()
                           ? quantity.name
                           : std::string(quantity.name) + "; smallest change not known"),
        gnuplot_quoted(quantity.unit));
    if (i == 0) plot += "unset label\n";
  }
  plot += "unset multiplot\nunset offsets\n";
  gnuplot.draw("sessions", plot, width, height);
  return gnuplot.finish();
}

}  // namespace condyle::host
