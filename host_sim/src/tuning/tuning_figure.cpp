// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/gnuplot.h"
#include "recordings/recording_files.h"
#include "statistics/quantile.h"
#include "tuning/tuning_report.h"

namespace condyle::host {
namespace {

constexpr double kDeepest = -10;  // of the profiles
constexpr std::size_t kMostStretches = 2000;
constexpr std::uint64_t kFewestShown = 10;  // innovations of a stretch

// The surface as rows of cells; a blank line ends each row.
std::string surface_data(const LikelihoodTuning& tuning) {
  const LikelihoodSurface& surface = *tuning.surface;
  std::string text = "$surface << EOD\n";
  std::size_t i = 0;
  for (const double q : surface.jerk_density_m2_s5) {
    for (const double sd_m : surface.position_sd_m) {
      text += fmt::format("{:.9g} {:.9g} {:.9g}\n", std::log10(1e3 * sd_m), std::log10(q),
                          std::log10(1 - std::min(surface.log_likelihood[i++], 0.0)));
    }
    text += "\n";
  }
  text += "EOD\n$optima << EOD\n";
  for (const SearchOptimum& optimum : tuning.white.search.optima) {
    text += fmt::format("{:.9g} {:.9g}\n", (0.5 * optimum.point[0]) / std::log(10.0) + 3,
                        optimum.point[1] / std::log(10.0));
  }
  return text + "EOD\n";
}

std::string profile_data(const LikelihoodTuning& tuning) {
  std::string text;
  const auto add = [&text](const char* name, const FittedParameter& parameter, double scale) {
    text += fmt::format("${} << EOD\n", name);
    for (const ProfilePoint& point : parameter.profile) {
      text += fmt::format("{:.9g} {:.9g}\n", scale * point.value, point.log_likelihood);
    }
    text += "EOD\n";
  };
  add("sd_profile", tuning.white.parameters[0], 1e3);
  add("q_profile", tuning.white.parameters[1], 1);
  return text;
}

std::string correlation_data(const char* name, const CrossValidation& check) {
  std::string text = fmt::format("${} << EOD\n", name);
  for (std::size_t lag = 0; lag < check.correlation.size(); ++lag) {
    text += fmt::format("{} {:.9g} {:.9g}\n", lag + 1, check.correlation[lag].value,
                        check.correlation[lag].bound);
  }
  return text + "EOD\n";
}

// NIS of stretches, one recording after the other, thinned if there are many.
std::string stretch_data(const LikelihoodTuning& tuning) {
  const auto& stretches = tuning.written_check.stretches;
  const std::size_t stride = stretches.size() / kMostStretches + 1;
  std::string fitted = "$fitted << EOD\n", held_out = "$held_out << EOD\n";
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const StretchInnovations& stretch = stretches[i];
    if (i / 3 % stride != 0 || stretch.count < kFewestShown) continue;
    (stretch.is_held_out ? held_out : fitted) +=
        fmt::format("{} {:.9g}\n", i + 1, std::max(stretch.mean_nis, 0.01));
  }
  // gnuplot needs at least one row in a block.
  return fitted + "0 NaN\nEOD\n" + held_out + "0 NaN\nEOD\n";
}

std::string surface_plot() {
  return "unset logscale\nset xrange [*:*]\nset yrange [*:*]\n"
         "set origin 0,0.48\nset size 0.5,0.47\nset title 'log likelihood: worse than the best by' "
         "noenhanced\n"
         "set xlabel 'noise (mm)'\nset ylabel 'jerk density (m^2/s^5)' noenhanced\n"
         "set xtics 1 format '10^{%.0f}'\nset ytics 1 format '10^{%.0f}'\n"
         "set cbrange [0:*]\nset cbtics ('0' 0, '9' 1, '99' 2, '999' 3, '10^4' 4, '10^5' 5, '10^6' "
         "6)\n"
         "set palette defined (0 '#08306b', 1 '#6baed6', 2 '#c6dbef', 3 '#f0f4fa', 5 '#ffffff')\n"
         "set view map\nset autoscale xfix\nset autoscale yfix\n"
         "plot $surface with image notitle, $optima with points pt 2 ps 1.2 lw 2 lc rgb '#c00000' "
         "title 'optima found'\n";
}

std::string profile_plot(double x, const char* block, const char* title, const char* label,
                         double value) {
  return fmt::format(
      "set origin {0},0.48\nset size 0.25,0.47\nset title '{1}: profile' noenhanced\n"
      "set xlabel '{2}' noenhanced\nset ylabel ''\nset xtics autofreq format '%.3g' rotate by -40\n"
      "set ytics autofreq format '%g'\nset autoscale xfix\nset yrange [{3}:1.5]\n"
      "set arrow 1 from first {4:.9g}, graph 0 to first {4:.9g}, graph 1 nohead dt 2 "
      "lc rgb '#c00000'\n"
      "plot ${5} with lines lw 2 lc rgb '#0b559f' notitle, -1.92 dt 3 lc rgb '#303030' title "
      "'95 %'\nunset arrow 1\nset yrange [*:*]\nset xtics norotate\n",
      x, title, label, kDeepest, value, block);
}

// Bounds of a stretch's NIS, of the length that most have.
Interval usual_bounds(const std::vector<StretchInnovations>& stretches) {
  std::vector<std::uint64_t> counts;
  for (const StretchInnovations& stretch : stretches) {
    if (stretch.count >= kFewestShown) counts.push_back(stretch.count);
  }
  if (counts.empty()) return {1, 1};
  return mean_chi_square_bounds(1, upper_median(std::move(counts)), 0.95);
}

std::string held_out_plots(const LikelihoodTuning& tuning) {
  const bool serves = tuning.correlated_serves;
  const Interval bounds = usual_bounds(tuning.written_check.stretches);
  return fmt::format(
      "set origin 0,0\nset size 0.42,0.47\nset title 'correlation of held-out innovations' "
      "noenhanced\nset xlabel 'samples apart'\nset ylabel ''\nset xrange [0:{0}]\n"
      "set yrange [-1:1]\nset style fill solid\n"
      "plot $white_correlation using 1:3 with lines dt 2 lc rgb '#909090' title '95 % if white', "
      "$white_correlation using 1:(-$3) with lines dt 2 lc rgb '#909090' notitle, "
      "$white_correlation with impulses lw 4 lc rgb '#0b559f' title 'white noise'{1}\n"
      "set origin 0.42,0\nset size 0.58,0.47\nset title 'mean NIS of stretches{2}' noenhanced\n"
      "set xlabel 'stretch, one recording after the other'\nset xrange [0.5:{3}]\n"
      "set logscale y\nset yrange [*<0.5:2<*]\nset xtics format '%g'\n"
      "plot {4:.9g} dt 2 lc rgb '#909090' title '95 % of stretches', {5:.9g} dt 2 lc rgb '#909090' "
      "notitle, 1 lc rgb '#303030' notitle, $fitted with points pt 6 ps 0.8 lc rgb '#909090' title "
      "'fitted to', $held_out with points pt 7 ps 0.9 lc rgb '#b35900' title 'held out'\n",
      CrossValidation::kLags + 1,
      serves ? ", $correlated_correlation using ($1+0.3):2 with impulses lw 4 lc rgb '#b35900' "
               "title 'Gauss-Markov noise'"
             : "",
      serves ? ", as written" : "",
      static_cast<double>(tuning.written_check.stretches.size()) + 0.5, bounds.low, bounds.high);
}

}  // namespace

std::vector<std::unique_ptr<OutputFile>> draw_tuning(const std::string& directory,
                                                     const std::vector<TuningRecording>& recordings,
                                                     const LikelihoodTuning& tuning) {
  std::string name = recording_name(recordings.front().name);
  if (recordings.size() > 1) name += fmt::format(" and {} more", recordings.size() - 1);
  Gnuplot gnuplot(directory);
  gnuplot.send(surface_data(tuning) + profile_data(tuning) + stretch_data(tuning) +
               correlation_data("white_correlation", tuning.white.held_out));
  if (tuning.correlated_serves) {
    gnuplot.send(correlation_data("correlated_correlation", tuning.correlated->held_out));
  }
  const NoiseModel& best = tuning.white.values;
  gnuplot.draw(
      "tuning",
      fmt::format("set multiplot\nset key top right\n"
                  "set label 1 {} noenhanced at screen 0.5,0.975 center\n{}"
                  "unset label 1\n{}{}{}unset multiplot",
                  gnuplot_quoted("Tuning to " + name + ", white noise (research use only)"),
                  surface_plot(),
                  profile_plot(0.5, "sd_profile", "noise", "noise (mm)", 1e3 * best.position_sd_m),
                  profile_plot(0.75, "q_profile", "jerk", "jerk density (m^2/s^5)",
                               best.jerk_density_m2_s5),
                  held_out_plots(tuning)),
      1000, 680);
  return gnuplot.finish();
}

}  // namespace condyle::host
