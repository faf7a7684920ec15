// SPDX-License-Identifier: Apache-2.0
#include "evaluation/evaluation_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/gnuplot.h"

namespace condyle::host {
namespace {

constexpr const char* kTitleOptions = "font ',11'";

// Logarithmic: errors at the start and after a fault are many times the others.
void draw_velocity_error(Gnuplot& gnuplot, const std::string& title, const ErrorOverTime& errors) {
  std::string block = "$velocity << EOD\n";
  for (const auto& stretch : errors.stretches()) {
    block += fmt::format("{:.9g} {:.9g} {:.9g}\n", stretch.middle_s, stretch.error_rms * 1e3,
                         stretch.claimed_rms * 1e3);
  }
  gnuplot.send(block + "EOD\n");
  gnuplot.send(title_command(title, kTitleOptions));
  gnuplot.send(
      "set key top right\nset logscale y\nset xlabel 'time (s)'\n"
      "set ylabel 'velocity: error, rms over the runs (mm/s)'\n");
  gnuplot.draw("velocity_error",
               "plot $velocity using 1:2 with lines lw 1.6 lc rgb '#0b559f' title 'error against "
               "the truth', $velocity using 1:3 with lines lw 1.6 dt (8,6) lc rgb '#b35900' title "
               "'standard deviation that the estimator states'",
               960, 480);
  gnuplot.send("unset logscale\n");
}

// Estimate against truth, with the line of perfect measurement.
void draw_response(Gnuplot& gnuplot, const std::string& title, const char* name, const char* unit,
                   const std::vector<ResponsePair>& pairs) {
  const auto [low, high] = std::minmax_element(
      pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.truth < b.truth; });
  if (!(high->truth > low->truth)) return;  // without a varying truth there is no response
  std::string block = fmt::format("${} << EOD\n", name);
  for (const ResponsePair& pair : pairs) {
    if (std::isfinite(pair.estimate)) block += fmt::format("{} {}\n", pair.truth, pair.estimate);
  }
  gnuplot.send(block + "EOD\n");
  gnuplot.send(title_command(title, kTitleOptions));
  gnuplot.send(fmt::format(
      "set key left top\nset xlabel 'true effective {0} ({1})'\nset ylabel 'estimated {0} ({1})'\n",
      name, unit));
  gnuplot.draw(fmt::format("{}_response", name),
               fmt::format("plot x with lines dt 2 lc rgb '#0b559f' title 'a measurement would lie "
                           "here', ${} with points pt 7 ps 0.7 lc rgb '#606060' title 'estimate "
                           "at the end of a run (assumed)'",
                           name),
               640, 480);
}

}  // namespace

std::vector<std::unique_ptr<OutputFile>> draw_evaluation(const std::string& directory,
                                                         const std::string& title,
                                                         const Evaluation& evaluation) {
  Gnuplot gnuplot(directory);
  draw_velocity_error(gnuplot, title, evaluation.velocity_m_s);
  if (evaluation.is_computed(kFrictionError)) {
    draw_response(gnuplot, title, "friction", "Ns/m", evaluation.friction);
  }
  if (evaluation.is_computed(kMassError)) {
    draw_response(gnuplot, title, "mass", "kg", evaluation.mass);
  }
  return gnuplot.finish();
}

}  // namespace condyle::host
