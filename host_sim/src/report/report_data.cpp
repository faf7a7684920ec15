// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "hosted/files/clean_text.h"
#include "readings/readings_files.h"
#include "report/average_cycle_section.h"
#include "report/packed_values.h"
#include "report/report_page.h"

namespace condyle::host {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPoses = 8'192;

struct ChartText {
  const char *key, *title, *unit;
  double shown_per_si;
};
constexpr ChartText kChartTexts[ReportSeries::kCharts] = {
    {"position", "Position", "mm", 1e3},
    {"velocity", "Velocity", "mm/s", 1e3},
    {"acceleration", "Acceleration", "m/s^2", 1},
    {"friction", "Friction", "N s/m", 1},
    {"mass", "Effective mass", "kg", 1}};

// First and last run of each stretch whose values are assumed.
Json assumed_stretches(const ReportSeries& series, std::size_t chart, std::size_t axis) {
  Json json = Json::array();
  const auto& runs = series.runs();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i].curves[chart][axis].is_assumed) continue;
    const std::size_t first = i;
    while (i + 1 < runs.size() && runs[i + 1].curves[chart][axis].is_assumed) ++i;
    json.push_back({first, i});
  }
  return json;
}

// `has_band`: with half of the interval.
Json curve(const ReportSeries& series, std::size_t chart, std::size_t axis, bool has_band) {
  std::vector<double> low, high, half;
  const double scale = kChartTexts[chart].shown_per_si;
  bool is_single = true;
  for (const ReportSeries::Run& run : series.runs()) {
    const ReportSeries::Curve& one = run.curves[chart][axis];
    low.push_back(scale * static_cast<double>(one.low));
    high.push_back(scale * static_cast<double>(one.high));
    half.push_back(scale * static_cast<double>(one.half));
    is_single = is_single && !(one.low < one.high);
  }
  const bool is_one = chart >= ReportSeries::friction || series.axis_count() == 1;
  Json json = {{"name", is_one ? kChartTexts[chart].title : std::string(1, "xyz"[axis])},
               {"low", packed_values(low)}};
  if (!is_single) json["high"] = packed_values(high);  // else the same
  if (has_band) json["half"] = packed_values(half);
  Json assumed = assumed_stretches(series, chart, axis);
  if (!assumed.empty()) json["assumed"] = std::move(assumed);
  return json;
}

Json curves(const ReportSeries& series, std::size_t chart, bool has_band) {
  Json json = Json::array();
  const int axes = chart >= ReportSeries::friction ? 1 : series.axis_count();
  for (int axis = 0; axis < axes; ++axis) {
    json.push_back(curve(series, chart, static_cast<std::size_t>(axis), has_band));
  }
  return json;
}

std::string times_of(const ReportSeries& series, double origin_s) {
  std::vector<double> time_s;
  for (const auto& run : series.runs()) time_s.push_back(run.time_s - origin_s);
  return packed_times(time_s);
}

Json series_json(const ReportSection& section) {
  const ReportSeries& series = section.series;
  std::vector<double> events_s;
  for (const double event_s : series.event_times_s()) {
    events_s.push_back(std::round((event_s - section.origin_s) * 1e4) / 1e4);
  }
  Json json = {{"time", times_of(series, section.origin_s)},
               {"events", events_s},
               {"samples_per_point", series.samples_per_run()},
               {"charts", Json::array()}};
  for (std::size_t chart = 0; chart < ReportSeries::kCharts; ++chart) {
    const Provenance provenance = series.provenance(static_cast<ReportSeries::Chart>(chart));
    if (provenance == Provenance::not_computed) continue;
    json["charts"].push_back({{"key", kChartTexts[chart].key},
                              {"title", kChartTexts[chart].title},
                              {"unit", kChartTexts[chart].unit},
                              {"provenance", provenance_name(provenance)},
                              {"curves", curves(series, chart, true)}});
  }
  if (section.fine.samples_per_run() == series.samples_per_run()) return json;
  // The bands of a closer look are those of the whole, the widest around.
  Json& fine = json["fine"] = {{"time", times_of(section.fine, section.origin_s)}};
  for (const std::size_t chart : {ReportSeries::position, ReportSeries::velocity}) {
    fine[kChartTexts[chart].key] = curves(section.fine, chart, false);
  }
  return json;
}

Json track(const std::vector<Eigen::Vector3d>& points_m, std::size_t stride) {
  Json json = Json::array();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (std::size_t k = 0; k < points_m.size(); k += stride) {
      values.push_back(points_m[k][axis] * 1e3);
    }
    json.push_back(packed_values(values));
  }
  return json;
}

Json point(const Eigen::Vector3d& point_m) {
  return {point_m.x() * 1e3, point_m.y() * 1e3, point_m.z() * 1e3};
}

Json path_json(const ReportSection& section) {
  const Analysis& analysis = *section.analysis;
  const JawPath& path = analysis.path;
  const std::size_t stride = 1 + path.time_s.size() / kMostPoses;
  std::vector<double> time_s;
  for (std::size_t k = 0; k < path.time_s.size(); k += stride) {
    time_s.push_back(path.time_s[k] - section.origin_s);
  }
  Json json = {{"time", packed_times(time_s)}, {"incisor", track(path.incisor_m, stride)}};
  if (!analysis.has_landmarks) return json;
  json["condyle_left"] = track(path.condyle_m[0], stride);
  json["condyle_right"] = track(path.condyle_m[1], stride);
  json["at"] = {{"incisor", point(path.incisor_at_m)},
                {"condyle_left", point(path.condyle_at_m[0])},
                {"condyle_right", point(path.condyle_at_m[1])}};
  return json;
}

Json recording_json(const ReportSection& section) {
  Json json = {{"name", clean_line(section.recording)},
               {"identity", identity_json(section.identity)},
               {"origin_s", section.origin_s},
               {"tasks", Json::array()}};
  if (!section.series.runs().empty()) json["series"] = series_json(section);
  if (!section.estimates_json.empty()) json["estimates"] = Json::parse(section.estimates_json);
  if (!section.analysis) return json;
  for (const Task& task : section.analysis->tasks) {
    if (task.kind == TaskKind::whole) continue;
    json["tasks"].push_back({{"task", name_of(task.kind)},
                             {"begin_s", task.begin_s - section.origin_s},
                             {"end_s", task.end_s - section.origin_s}});
  }
  json["average_cycles"] = average_cycle_json(*section.analysis);
  if (section.analysis->unusable.empty() && !section.analysis->path.time_s.empty()) {
    json["path"] = path_json(section);
  }
  return json;
}

}  // namespace

std::string report_data(const std::vector<ReportSection>& sections, const SessionOverlay* overlay) {
  Json json = {{"format", "condyle-report-1"}, {"recordings", Json::array()}};
  std::vector<Analysis> analyses;
  for (const ReportSection& section : sections) {
    json["recordings"].push_back(recording_json(section));
    if (!section.analysis) continue;
    analyses.push_back(*section.analysis);
    analyses.back().path = {};
  }
  json["readings"] = Json::parse(readings_json(analyses));
  if (overlay != nullptr) json["sessions"] = overlay_json(*overlay);
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) safe += c == '<' ? "\\u003c" : std::string(1, c);
  return safe;
}

}  // namespace condyle::host
