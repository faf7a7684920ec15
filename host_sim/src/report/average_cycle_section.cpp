// SPDX-License-Identifier: Apache-2.0
#include "report/average_cycle_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "readings/strokes.h"
#include "report/html_table.h"
#include "report/html_text.h"
#include "report/plane_drawing.h"

namespace condyle::host {
namespace {

constexpr std::size_t kMostCycles = 30;  // drawn behind the average

// The averages to draw: of the sides that are known, or of all cycles.
std::vector<const AverageCycle*> drawn_averages(const Analysis& analysis) {
  std::vector<const AverageCycle*> sides, all;
  for (const AverageCycle& average : analysis.average_cycles) {
    if (!average.withheld.empty()) continue;
    (average.side == "all" ? all : sides).push_back(&average);
  }
  return sides.empty() ? all : sides;
}

// Class of its lines.
std::string style_of(const AverageCycle& average) {
  return average.side == "left" || average.side == "right" ? average.side : "chewing";
}

// The band of one half: out along one edge, back along the other.
DrawnBand band_of(const AverageCycle& average, bool is_closing) {
  DrawnBand band{style_of(average), {}};
  std::vector<std::array<double, 2>> back;
  for (const AverageCycle::Point& point : average.points) {
    if (point.is_closing != is_closing) continue;
    const double y = point.mean_mm.y(), half = point.half_interval_mm.y(), z = point.mean_mm.z();
    band.outline_mm.push_back({y + half, z});
    back.push_back({y - half, z});
  }
  band.outline_mm.insert(band.outline_mm.end(), back.rbegin(), back.rend());
  return band;
}

DrawnPath path_of(const AverageCycle& average, bool is_closing) {
  DrawnPath path{style_of(average) + (is_closing ? " closing" : ""), {{}}};
  for (const AverageCycle::Point& point : average.points) {
    if (point.is_closing == is_closing) path.pieces_m[0].push_back(point.mean_mm * 1e-3);
  }
  return path;
}

std::string frontal_svg(const Analysis& analysis, const std::vector<const AverageCycle*>& shown) {
  PlaneDrawing drawing;
  drawing.title = "average cycle, frontal";
  drawing.x_label = analysis.has_landmarks ? "left" : "y";
  drawing.y_label = analysis.has_landmarks ? "up" : "z";
  drawing.x = 1;
  std::vector<DrawnPath> paths;
  const std::vector<double>& time_s = analysis.path.time_s;
  const double gap_s = longest_drawn_gap_s(time_s);
  for (const AnalysedCycle& cycle : analysis.cycles) {
    if (cycle.number == 0) continue;
    const auto begin = analysis.path.incisor_m.begin();
    DrawnPath path{"one", {}};
    for (const SampleRun& run :
         runs_without_gap(time_s, {cycle.cycle.begin, cycle.cycle.end + 1}, gap_s)) {
      path.pieces_m.push_back({begin + static_cast<std::ptrdiff_t>(run.begin),
                               begin + static_cast<std::ptrdiff_t>(run.end)});
    }
    paths.push_back(std::move(path));
    if (paths.size() == kMostCycles) break;
  }
  for (const AverageCycle* const average : shown) {
    for (const bool is_closing : {false, true}) {
      drawing.bands.push_back(band_of(*average, is_closing));
      paths.push_back(path_of(*average, is_closing));
    }
  }
  return plane_svg(drawing, paths);
}

// Height over the time from the closed instant.
std::string time_svg(const std::vector<const AverageCycle*>& shown) {
  constexpr double kLeft = 44, kTop = 8, kWidth = 460, kHeight = 190;  // px
  double end_s = 0, low_mm = 0, high_mm = 0;
  for (const AverageCycle* const average : shown) {
    for (const AverageCycle::Point& point : average->points) {
      end_s = std::max(end_s, point.time_s);
      low_mm = std::min(low_mm, point.mean_mm.z() - point.half_interval_mm.z());
      high_mm = std::max(high_mm, point.mean_mm.z() + point.half_interval_mm.z());
    }
  }
  const auto at = [&](double time_s, double z_mm) {
    return fmt::format("{:.1f},{:.1f} ", kLeft + kWidth * time_s / end_s,
                       kTop + kHeight * (high_mm - z_mm) / (high_mm - low_mm));
  };
  std::string text = fmt::format(
      "<svg class=\"plane times\" role=\"img\" aria-label=\"average cycle over time\" viewBox=\"0 "
      "0 "
      "{:.0f} {:.0f}\">",
      kLeft + kWidth + 12, kTop + kHeight + 34);
  const double step_mm = high_mm - low_mm > 12 ? 5 : 2;
  for (double z = std::ceil(low_mm / step_mm) * step_mm; z <= high_mm; z += step_mm) {
    const double y = kTop + kHeight * (high_mm - z) / (high_mm - low_mm);
    text += fmt::format(
        "<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/><text "
        "font-size=\"12\" x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:g}</text>",
        kLeft, kLeft + kWidth, y, kLeft - 5, y + 4, z + 0.0);
  }
  for (double t = 0; t <= end_s; t += 0.2) {
    text += fmt::format(
        "<text font-size=\"12\" x=\"{:.1f}\" y=\"{:.0f}\" text-anchor=\"middle\">{:.1f}</text>",
        kLeft + kWidth * t / end_s, kTop + kHeight + 14, t);
  }
  text += fmt::format(
      "<text font-size=\"12\" x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"end\">time from the closed "
      "position (s)</text><text font-size=\"12\" x=\"{:.0f}\" y=\"{:.0f}\">up (mm)</text>",
      kLeft + kWidth, kTop + kHeight + 30, kLeft + 6, kTop + kHeight - 6);
  for (const AverageCycle* const average : shown) {
    std::string out, back, middle;
    for (const AverageCycle::Point& point : average->points) {
      const double z = point.mean_mm.z(), half = point.half_interval_mm.z();
      out += at(point.time_s, z + half);
      back = at(point.time_s, z - half) + back;
      middle += at(point.time_s, z);
    }
    text += fmt::format(
        "<polygon class=\"band {0}\" points=\"{1}{2}\"/><polyline class=\"path {0}\" "
        "points=\"{3}\"/>",
        style_of(*average), out, back, middle);
  }
  return text + "</svg>";
}

std::string points_table(const Analysis& analysis, const std::string& prefix) {
  HtmlTable table(prefix, "average_cycle",
                  {"side", "half", "share of its time", "time (s)", "x (mm)", "x half interval",
                   "y (mm)", "y half interval", "z (mm)", "z half interval"});
  for (const AverageCycle& average : analysis.average_cycles) {
    for (const AverageCycle::Point& point : average.points) {
      table.begin_row();
      table.cell(average.side);
      table.cell(point.is_closing ? "closing" : "opening");
      table.number_cell(rounded(point.share, 3));
      table.number_cell(rounded(point.time_s, 4));
      for (int axis = 0; axis < 3; ++axis) {
        const int digits = digits_for(point.half_interval_mm[axis]);
        table.number_cell(rounded(point.mean_mm[axis], digits));
        table.number_cell(rounded(point.half_interval_mm[axis], digits));
      }
      table.end_row();
    }
  }
  const std::string html = table.html("Points of the average cycles");
  return html.empty()
             ? html
             : "<details><summary>Points of the average cycles</summary>\n" + html + "</details>\n";
}

}  // namespace

std::string average_cycle_html(const Analysis& analysis, const std::string& prefix) {
  if (analysis.average_cycles.empty() || !analysis.unusable.empty()) return {};
  std::string text = "<h3>Average chewing cycle</h3>\n";
  const auto shown = drawn_averages(analysis);
  if (!shown.empty()) {
    text += fmt::format(
        "<div class=\"row\"><figure>{}<figcaption>frontal, seen from the front</figcaption>"
        "</figure>\n<figure>{}<figcaption>height over time{}</figcaption></figure></div>\n",
        frontal_svg(analysis, shown), time_svg(shown),
        shown.size() > 1 ? "; of the right side dashed" : "");
    text += "<p>";
    for (const AverageCycle* const average : shown) {
      text += fmt::format(
          "<svg width=\"28\" height=\"8\" aria-hidden=\"true\"><line class=\"{}\" "
          "stroke-width=\"3\" x1=\"0\" x2=\"28\" y1=\"4\" y2=\"4\"/></svg> {}: mean of {} cycles. ",
          style_of(*average), html_text(average->side), average->cycles);
    }
    text +=
        "Dashed: closing. Band: 95 % interval of the mean. Grey: single cycles, thirty at "
        "most.</p>\n";
  }
  for (const AverageCycle* const average : shown) {
    if (average->assumed.empty()) continue;
    text += fmt::format("<p>{} {} The average is derived: {}.</p>\n", provenance_mark("derived"),
                        html_text(average->side), html_text(average->assumed));
  }
  for (const AverageCycle& average : analysis.average_cycles) {
    if (average.withheld.empty()) continue;
    text += fmt::format("<p>{} The average of {} cycles is withheld: {}.</p>\n",
                        provenance_mark("withheld"), html_text(average.side),
                        reason_html(average.withheld));
  }
  return text + points_table(analysis, prefix);
}

nlohmann::ordered_json average_cycle_json(const Analysis& analysis) {
  using Json = nlohmann::ordered_json;
  const auto vector = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
  Json all = Json::array();
  for (const AverageCycle& average : analysis.average_cycles) {
    Json one = {{"side", average.side},
                {"cycles", average.cycles},
                {"withheld", average.withheld},
                {"assumed", average.assumed},
                {"points", Json::array()}};
    for (const AverageCycle::Point& point : average.points) {
      one["points"].push_back({{"half", point.is_closing ? "closing" : "opening"},
                               {"share", point.share},
                               {"time_s", point.time_s},
                               {"mean_mm", vector(point.mean_mm)},
                               {"sd_mm", vector(point.sd_mm)},
                               {"half_interval_mm", vector(point.half_interval_mm)}});
    }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace condyle::host
