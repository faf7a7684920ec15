// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "condyle/estimator/published/published_cascade.h"
#include "output/gnuplot.h"
#include "tuning/published_tuning_report.h"

namespace condyle::host {
namespace {

constexpr std::size_t kMostPoints = 2000;  // of a curve

// Columns: time, friction, mass.
std::string curve_block(std::size_t number, PublishedParameters parameters,
                        const PublishedRecording& recording) {
  parameters.sample_time_s = recording.sample_time_s;
  PublishedCascade<double> cascade(parameters);
  const std::size_t samples = recording.position_m.size();
  const std::size_t stride = (samples + kMostPoints - 1) / kMostPoints;
  std::string text = fmt::format("$tuning{} << EOD\n", number);
  for (std::size_t i = 0; i < samples; ++i) {
    const auto estimate = cascade.step(recording.position_m[i]);
    if (i % stride != 0 && i + 1 != samples) continue;
    text += fmt::format("{:.9g} {:.9g} {:.9g}\n", static_cast<double>(i) * recording.sample_time_s,
                        estimate.friction_Ns_m.value, estimate.mass_kg.value);
  }
  return text + "EOD\n";
}

// 1, 2 and 5 times the powers of ten from `low` to `high`, separated by commas: gnuplot's own ticks
// are only powers of ten.
std::string round_numbers(double low, double high) {
  std::string text;
  for (double power = std::pow(10, std::floor(std::log10(low))); power <= high; power *= 10) {
    for (const double number : {power, 2 * power, 5 * power}) {
      if (number < low || number > high) continue;
      text += fmt::format("{}{:.3g}", text.empty() ? "" : ",", number);
    }
  }
  return text;
}

// Labels of frictions at the right edge, without overlap.
std::string end_labels(const std::vector<const PublishedTuning*>& drawn, double low, double high) {
  constexpr double kApart = 0.045;  // of the axis
  std::string text;
  double last = -1;
  for (const PublishedTuning* tuning : drawn) {
    const double at = std::log(tuning->friction_Ns_m / low) / std::log(high / low);
    if (at < last + kApart) continue;
    last = at;
    text += fmt::format("set label '{:.3g}' at graph 1.01, graph {:.4f} left font ',9'\n",
                        tuning->friction_Ns_m, at);
  }
  return text;
}

std::string plot_curves(std::size_t count, int column, const char* label) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += fmt::format("{}$tuning{} using 1:{} with lines lw 1.4 dt (8,6) lc rgb '#606060' {}",
                        i == 0 ? "plot " : ", ", i, column,
                        i == 0 ? fmt::format("title '{}'", label) : "notitle");
  }
  return text;
}

}  // namespace

std::vector<std::unique_ptr<OutputFile>> draw_published_tunings(
    const std::string& directory, const std::string& name, const PublishedTuningResult& result,
    const PublishedRecording& recording) {
  if (result.tunings.empty()) return {};
  std::vector<const PublishedTuning*> drawn;
  for (const std::size_t i : tunings_spread_evenly(result, 12)) {
    drawn.push_back(&result.tunings[i]);
  }
  Gnuplot gnuplot(directory);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    gnuplot.send(curve_block(i, drawn[i]->parameters, recording));
  }
  const auto time_s = [&](std::size_t i) {
    return static_cast<double>(i) * recording.sample_time_s;
  };
  const double end_s = time_s(recording.position_m.size() - 1);
  const double judged_s = time_s(first_judged_sample(recording));
  // The figure includes the initial friction, unless it is 0.
  const double initial = result.base.friction.initial_Ns_m;
  const double low =
      std::min(initial > 0 ? initial : result.lowest_friction_Ns_m, result.lowest_friction_Ns_m) /
      1.5;
  const double high = std::max(initial, result.highest_friction_Ns_m) * 1.8;
  const double m0 = result.base.assumed_mass_kg;
  const std::string title =
      title_command(fmt::format("Friction and mass, assumed: tuning determines them; each tuning "
                                "satisfies the published criterion, {}",
                                name),
                    "font ',11'");
  gnuplot.send(
      fmt::format("set key Left reverse samplen 3 opaque\n"
                  "set object 1 rectangle from {0:.9g}, graph 0 to {1:.9g}, graph 1 behind "
                  "fc rgb '#f2f2f2' fs solid noborder\n",
                  judged_s, end_s));
  gnuplot.draw(
      "published_tunings",
      fmt::format(
          "set multiplot\nset lmargin 10\nset rmargin 9\nset xrange [0:{0:.9g}]\n"
          "set origin 0,0.4\nset size 1,0.6\n{1}set ylabel 'friction (Ns/m)'\nset format x ''\n"
          "unset xlabel\nset logscale y\nset yrange [{2:.9g}:{3:.9g}]\nset ytics ({14})\nset key "
          "center top\n"
          "set label 'last quarter' at {4:.9g}, graph 0.95 center font ',9'\n{5}"
          "set label 'Ns/m' at graph 1.01, graph 1 left font ',9'\n{6}\nunset label\n"
          "set origin 0,0\nset size 1,0.42\nunset title\nset ylabel 'mass (kg)'\nset format x\n"
          "set xlabel 'time since the first sample (s)'\nunset logscale y\n"
          "set ytics autofreq\n"
          "set object 2 rectangle from graph 0, first {7:.9g} to graph 1, first {8:.9g} behind "
          "fc rgb '#d0d0d0' fs solid noborder\nset yrange [{9:.9g}:{10:.9g}]\n"
          "set key center bottom\n{11}, "
          "NaN with lines lw 8 lc rgb '#d0d0d0' title 'within {12:g} % of the assumed {13:g} kg'\n"
          "unset object 2\nunset multiplot",
          end_s, title, low, high, (judged_s + end_s) / 2, end_labels(drawn, low, high),
          plot_curves(drawn.size(), 2, "friction of a tuning: ASSUMED, not measured"),
          (1 - kMatchingTolerance) * m0, (1 + kMatchingTolerance) * m0, 0.6 * m0, 1.25 * m0,
          plot_curves(drawn.size(), 3, "mass of the same tunings: ASSUMED, not measured"),
          100 * kMatchingTolerance, m0, round_numbers(low, high)),
      900, 640);
  return gnuplot.finish();
}

}  // namespace condyle::host
