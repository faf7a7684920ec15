// SPDX-License-Identifier: Apache-2.0
#include "report/sample_times_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "statistics/quantile.h"

namespace condyle::host {
namespace {

// As shown with one digit.
double without_minus_zero(double value) {
  return std::abs(value) < 0.05 ? 0 : value;
}

// Heights are logarithms: a rare step is seen beside a million usual ones.
std::string histogram(const SampleTimes& times) {
  constexpr double kLeft = 60, kTop = 10, kWidth = 400, kHeight = 110;  // px
  std::size_t most = 1;
  for (const std::size_t height : times.heights) most = std::max(most, height);
  const double decades = std::log10(static_cast<double>(most)) + 0.5;
  const auto bar_height = [&](std::size_t count) {
    return count == 0 ? 0
                      : kHeight * (std::log10(static_cast<double>(count)) + 0.5) / (decades + 0.2);
  };
  const double bottom = kTop + kHeight;
  std::string text = fmt::format(
      "<svg class=\"quality\" role=\"img\" aria-label=\"histogram of the steps between usable "
      "samples\" viewBox=\"0 0 {:.0f} {:.0f}\">",
      kLeft + kWidth + 20, bottom + 38);
  for (double count = 1; count <= static_cast<double>(most); count *= 10) {
    const double y = bottom - bar_height(static_cast<std::size_t>(count));
    text += fmt::format(
        "<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/><text x=\"{3}\" "
        "y=\"{4:.1f}\" text-anchor=\"end\">{5:.0f}</text>",
        kLeft, kLeft + kWidth, y, kLeft - 5, y + 4, count);
  }
  const double width = kWidth / static_cast<double>(times.heights.size());
  for (std::size_t i = 0; i < times.heights.size(); ++i) {
    const double height = bar_height(times.heights[i]);
    if (height == 0) continue;
    text += fmt::format(
        "<rect class=\"bar\" x=\"{:.2f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{:.1f}\"/>",
        kLeft + width * static_cast<double>(i), bottom - height, width, height);
  }
  for (int steps = 0; steps <= static_cast<int>(SampleTimes::kWidest); ++steps) {
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.0f}\" text-anchor=\"middle\">{:.4g}</text>",
                        kLeft + kWidth * steps / SampleTimes::kWidest, bottom + 15,
                        1e3 * steps * times.usual_step_s);
  }
  return text +
         fmt::format(
             "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"end\">step between usable samples "
             "(ms)</text></svg>",
             kLeft + kWidth, bottom + 32);
}

std::string strip(const SampleTimes& times, double origin_s) {
  constexpr double kLeft = 10, kWidth = 900, kHeight = 22;  // px
  const double span_s = times.end_s - times.begin_s;
  const auto x = [&](double time_s) { return kLeft + kWidth * (time_s - times.begin_s) / span_s; };
  std::string text = fmt::format(
      "<svg class=\"quality strip\" role=\"img\" aria-label=\"gaps over time\" viewBox=\"0 0 "
      "{:.0f} "
      "{:.0f}\"><rect class=\"there\" x=\"{:.0f}\" y=\"4\" width=\"{:.0f}\" height=\"{:.0f}\"/>",
      kWidth + 2 * kLeft, kHeight + 26, kLeft, kWidth, kHeight);
  double drawn = -1;  // up to here, so that thousands of gaps make at most one mark a pixel
  for (const SampleTimes::Gap& gap : times.gaps) {
    const double begin = std::max(x(gap.begin_s), drawn), end = std::max(x(gap.end_s), begin + 1);
    if (x(gap.end_s) <= drawn) continue;
    drawn = end;
    text +=
        fmt::format("<rect class=\"gap\" x=\"{:.1f}\" y=\"1\" width=\"{:.1f}\" height=\"{:.0f}\"/>",
                    begin, end - begin, kHeight + 6);
  }
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const char* const anchor = share == 0 ? "start" : share == 1 ? "end" : "middle";
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.0f}\" text-anchor=\"{}\">{:.1f}{}</text>",
                        kLeft + kWidth * share, kHeight + 22, anchor,
                        without_minus_zero(times.begin_s + share * span_s - origin_s),
                        share == 1 ? " s" : "");
  }
  return text + "</svg>";
}

std::string number_text(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

SampleTimes sample_times(const std::vector<double>& time_s) {
  SampleTimes times;
  times.begin_s = time_s.front();
  times.end_s = time_s.back();
  std::vector<double> steps_s;
  steps_s.reserve(time_s.size());
  for (std::size_t k = 1; k < time_s.size(); ++k) steps_s.push_back(time_s[k] - time_s[k - 1]);
  times.usual_step_s = lower_quantile(steps_s, 0.5);
  times.low_step_s = lower_quantile(steps_s, 0.025);
  times.high_step_s = lower_quantile(steps_s, 0.975);
  times.heights.assign(
      static_cast<std::size_t>(std::lround(SampleTimes::kWidest / SampleTimes::kBin)), 0);
  for (std::size_t k = 1; k < time_s.size(); ++k) {
    const double step_s = time_s[k] - time_s[k - 1];
    // A usual step lies in the middle of its bin.
    const auto bin =
        static_cast<std::size_t>(step_s / times.usual_step_s / SampleTimes::kBin + 0.5);
    if (bin < times.heights.size()) {
      ++times.heights[bin];
    } else {
      ++times.longer;
    }
    if (step_s <= SampleTimes::kGap * times.usual_step_s) continue;
    times.gaps.push_back({time_s[k - 1], time_s[k]});
    times.missing_s += step_s - times.usual_step_s;
    times.longest_gap_s = std::max(times.longest_gap_s, step_s);
  }
  return times;
}

std::string sample_times_html(const std::vector<double>& time_s, double origin_s) {
  if (time_s.size() < 3) return {};
  const SampleTimes times = sample_times(time_s);
  if (!(times.usual_step_s > 0)) return {};
  std::string text = "<h3>Times of the samples</h3>\n<figure>" + strip(times, origin_s);
  const double span_s = times.end_s - times.begin_s;
  text +=
      times.gaps.empty()
          ? "<figcaption>no gap between usable samples</figcaption>"
          : fmt::format(
                "<figcaption>{} longer than {:g} usual steps without a usable sample: {:.3g} s in "
                "all, {:.2g} % of the time; the longest {:.3g} s</figcaption>",
                number_text(times.gaps.size(), "gap"), SampleTimes::kGap, times.missing_s,
                100 * times.missing_s / span_s, times.longest_gap_s);
  text += "</figure>\n<figure class=\"half\">" + histogram(times);
  text += fmt::format(
      "<figcaption>number of steps of each length, logarithmic; usual step {:.4g} ms; 95 % of the "
      "steps from {:.4g} to {:.4g} ms",
      1e3 * times.usual_step_s, 1e3 * times.low_step_s, 1e3 * times.high_step_s);
  if (times.longer > 0) {
    text += fmt::format("; not drawn: {} of more than {:.4g} ms", number_text(times.longer, "step"),
                        1e3 * SampleTimes::kWidest * times.usual_step_s);
  }
  return text + "</figcaption></figure>\n";
}

}  // namespace condyle::host
