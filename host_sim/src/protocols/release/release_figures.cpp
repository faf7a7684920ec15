// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "output/gnuplot.h"
#include "protocols/release/release_report.h"
#include "recordings/recording_files.h"

namespace condyle::host {
namespace {

constexpr double kBefore_s = 0.2, kAfter_s = 0.2;  // of the recording, shown beside the release

std::string data_blocks(const FittedRelease& release) {
  const ReleaseStretch& stretch = release.stretch;
  const double begin_s = stretch.time_s.front(), end_s = stretch.time_s.back();
  std::string text = "$all << EOD\n";
  for (std::size_t i = 0; i < stretch.all_time_s.size(); ++i) {
    const double time_s = stretch.all_time_s[i];
    if (time_s < begin_s - kBefore_s || time_s > end_s + kAfter_s) continue;
    text += fmt::format("{:.9g} {:.9g}\n", time_s, 1e3 * stretch.all_position_m[i]);
  }
  text += "EOD\n$fit << EOD\n";
  constexpr int kPoints = 400;
  for (int i = 0; i <= kPoints; ++i) {
    const double t = (end_s - begin_s) * i / kPoints;
    text += fmt::format("{:.9g} {:.9g}\n", begin_s + t, 1e3 * release_position(release.fit, t));
  }
  text += "EOD\n$residuals << EOD\n";
  for (std::size_t i = 0; i < stretch.time_s.size(); ++i) {
    const double e =
        stretch.position_m[i] - release_position(release.fit, stretch.time_s[i] - begin_s);
    text += fmt::format("{:.9g} {:.9g}\n", stretch.time_s[i], 1e3 * e);
  }
  return text + "EOD\n";
}

std::string plot_command(const FittedRelease& release, const std::string& title) {
  const double begin_s = release.stretch.time_s.front(), end_s = release.stretch.time_s.back();
  const double band_mm = 1e3 * 1.96 * release.fit.noise_sd_m;
  return fmt::format(
      "set multiplot\nset lmargin 10\nset rmargin 3\nset xrange [{0:.9g}:{1:.9g}]\n"
      "set origin 0,0.36\nset size 1,0.64\n{2}set ylabel 'position (mm)'\nset format x ''\n"
      "unset xlabel\nset yrange [*:*]\nset key right top\n"
      "plot $fit with lines lw 2 lc rgb '#0b559f' title 'fitted release', "
      "$all with points pt 7 ps 0.6 lc rgb '#303030' title 'measured position'\n"
      "set origin 0,0\nset size 1,0.38\nunset title\nset ylabel 'residual (mm)'\nset format x\n"
      "set xlabel 'time since the first sample (s)'\nset key right top\n"
      "set yrange [*<{3:.9g}:{4:.9g}<*]\n"
      "plot {5:.9g} with lines dt 2 lc rgb '#909090' title '95 % of the noise', "
      "{6:.9g} with lines dt 2 lc rgb '#909090' notitle, "
      "$residuals with impulses lc rgb '#0b559f' notitle, "
      "$residuals with points pt 7 ps 0.4 lc rgb '#0b559f' notitle\n"
      "unset multiplot",
      begin_s - kBefore_s, end_s + kAfter_s, title_command(title, "font ',11'"), -2.2 * band_mm,
      2.2 * band_mm, band_mm, -band_mm);
}

}  // namespace

std::vector<std::unique_ptr<OutputFile>> draw_releases(
    const std::string& directory,
    const std::vector<std::pair<std::string, const FittedRelease*>>& releases) {
  Gnuplot gnuplot(directory);
  for (const auto& [name, release] : releases) {
    const std::string title =
        fmt::format("Passive release, {}{}", recording_name(release->recording),
                    has_trusted_residuals(release->fit) ? "" : ": NOT explained by the model");
    gnuplot.send(data_blocks(*release));
    gnuplot.draw(name, plot_command(*release, title), 840, 560);
  }
  return gnuplot.finish();
}

}  // namespace condyle::host
