// SPDX-License-Identifier: Apache-2.0
#include "report/session_overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "hosted/files/clean_text.h"
#include "report/change_drawing.h"
#include "report/html_table.h"
#include "report/html_text.h"
#include "report/plane_drawing.h"
#include "report/task_paths.h"

namespace condyle::host {
namespace {

using Json = nlohmann::ordered_json;
using ReadingKey = std::tuple<TaskKind, std::string, Side>;

// The mean of a task; null if the recording lacks it.
const JawReading* find_reading(const ReportSection& section, const ReadingKey& key) {
  if (!section.analysis) return nullptr;
  for (const JawReading& reading : section.analysis->readings) {
    if (reading.stroke == 0 && reading.task == std::get<0>(key) &&
        reading.definition->name == std::get<1>(key) && reading.side == std::get<2>(key)) {
      return &reading;
    }
  }
  return nullptr;
}

// A greatest value of the whole recording grows with its length, and so does an area.
unsigned depends_on(const JawReading& reading) {
  const bool is_area = reading.definition->unit == "mm^2" || reading.definition->unit == "mm^3";
  return reading.task == TaskKind::whole || is_area ? kDuration : kNothing;
}

QuantityComparison compare_reading(const JawReading& example, const ReadingKey& key,
                                   const std::vector<Session>& sessions,
                                   const std::vector<ReportSection>& sections) {
  const std::string side = name_of(example.side);
  QuantityComparison result;
  result.name = fmt::format(
      "{}, {}{}", example.task == TaskKind::whole ? "whole recording" : name_of(example.task),
      example.definition->name, side.empty() ? "" : ", " + side);
  result.column = std::string(example.definition->name);
  result.unit = std::string(example.definition->unit);
  std::size_t next = 0, withheld = 0;
  std::string reason;
  for (const Session& session : sessions) {
    auto& values = result.values.emplace_back();
    for (std::size_t i = 0; i < session.recordings.size(); ++i) {
      const JawReading* const reading = find_reading(sections[next++], key);
      const bool has = reading != nullptr && std::isfinite(reading->value) &&
                       reading->provenance != ReadingProvenance::withheld;
      values.push_back(has ? reading->value : JawReading::kNone);
      if (has) continue;
      ++withheld;
      reason = reading == nullptr ? "the task is missing" : reading->reason;
    }
  }
  if (withheld > 0) {
    result.withheld = fmt::format("withheld in {} of {} recordings: {}", withheld, next, reason);
    return result;
  }
  result.withheld = differing_conditions(sessions, depends_on(example));
  if (!result.withheld.empty()) return result;
  compare_values(std::vector<double>(sessions.size(), 0.0), result);
  return result;
}

SessionComparison compare_readings(const std::vector<Session>& sessions,
                                   const std::vector<ReportSection>& sections) {
  std::map<ReadingKey, const JawReading*> keys;
  std::vector<ReadingKey> order;
  for (const ReportSection& section : sections) {
    if (!section.analysis) continue;
    for (const JawReading& reading : section.analysis->readings) {
      if (reading.stroke > 0 || reading.provenance == ReadingProvenance::withheld) continue;
      const ReadingKey key{reading.task, std::string(reading.definition->name), reading.side};
      if (keys.emplace(key, &reading).second) order.push_back(key);
    }
  }
  SessionComparison comparison;
  for (const ReadingKey& key : order) {
    comparison.quantities.push_back(compare_reading(*keys[key], key, sessions, sections));
  }
  adjust_probabilities(comparison);
  return comparison;
}

std::string verdict(const SessionChange& change) {
  if (std::isnan(change.smallest)) return "not known: no repeats that differ";
  if (!change.exceeds()) return "not detectable";
  return change.exceeds_adjusted() ? "changed, also among so many comparisons"
                                   : "exceeds it, as chance may among so many comparisons";
}

std::string changes_table(const SessionOverlay& overlay, const SessionComparison& comparison,
                          const char* name, const char* heading) {
  HtmlTable table("sessions", name,
                  {"quantity", "unit", "from", "mean", "to", "mean", "change",
                   "smallest detectable change", "sd within a session", "result"});
  for (const QuantityComparison& quantity : comparison.quantities) {
    for (const SessionChange& change : quantity.changes) {
      const int digits = digits_for(std::isnan(change.smallest) ? 0 : change.smallest);
      table.begin_row(change.exceeds_adjusted() ? "changed" : "");
      table.cell(quantity.name);
      table.cell(quantity.unit == "1" ? "" : quantity.unit);
      table.cell(overlay.sessions[change.from].name);
      table.number_cell(rounded(quantity.means[change.from], digits));
      table.cell(overlay.sessions[change.to].name);
      table.number_cell(rounded(quantity.means[change.to], digits));
      table.number_cell(rounded(change.change, digits));
      table.number_cell(rounded(change.smallest, digits));
      table.number_cell(rounded(quantity.repeats.within_sd, digits));
      table.cell(verdict(change));
      table.end_row();
    }
  }
  return table.html(heading);
}

std::string not_compared_table(const SessionOverlay& overlay) {
  HtmlTable table("sessions", "not_compared", {"quantity", "reason"});
  for (const auto* comparison : {&overlay.readings, &overlay.motion}) {
    for (const QuantityComparison& quantity : comparison->quantities) {
      if (quantity.withheld.empty()) continue;
      table.begin_row("withheld");
      table.cell(quantity.name);
      table.html_cell(reason_html(quantity.withheld));
      table.end_row();
    }
  }
  return table.html("Not compared");
}

std::string key(std::size_t session) {
  return fmt::format(
      "<svg width=\"34\" height=\"10\" aria-hidden=\"true\"><line class=\"session{0}\" "
      "stroke-width=\"3\" x1=\"0\" x2=\"34\" y1=\"5\" y2=\"5\"/></svg>",
      session % kSessionStyles);
}

// The paths of all recordings, if they are in one frame: with landmarks.
std::string overlaid_paths(const SessionOverlay& overlay,
                           const std::vector<ReportSection>& sections) {
  std::vector<DrawnPath> paths;
  std::string notes;
  std::size_t next = 0;
  for (std::size_t i = 0; i < overlay.sessions.size(); ++i) {
    for (std::size_t k = 0; k < overlay.sessions[i].recordings.size(); ++k) {
      const ReportSection& section = sections[next++];
      if (!section.analysis || !section.analysis->has_landmarks ||
          !section.analysis->unusable.empty()) {
        continue;
      }
      TaskPaths tasks = task_paths(*section.analysis, section.analysis->path.incisor_m);
      const std::string missing = what_is_missing(tasks);
      if (!missing.empty()) {
        notes += fmt::format("<p>{}: {}</p>\n", html_text(section.recording), missing);
      }
      for (DrawnPath& path : tasks.paths) {
        path.kind = fmt::format("session{}", i % kSessionStyles);
        paths.push_back(std::move(path));
      }
    }
  }
  if (paths.empty()) {
    return "<p>Paths are not laid over each other: without --landmarks FILE each recording has its "
           "own frame.</p>\n";
  }
  std::string text = "<h3>Path of the lower incisor</h3>\n<div class=\"row\">";
  for (PlaneDrawing drawing : incisor_drawings(true)) {
    drawing.point.clear();
    text += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                        plane_svg(drawing, paths), html_text(drawing.title));
  }
  return text + "</div>\n" + notes;
}

Json comparison_json(const SessionOverlay& overlay, const SessionComparison& comparison) {
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
  Json all = Json::array();
  for (const QuantityComparison& quantity : comparison.quantities) {
    Json one = {{"quantity", quantity.name},
                {"column", quantity.column},
                {"unit", quantity.unit},
                {"withheld", quantity.withheld},
                {"values", quantity.values},
                {"within_session_sd", number(quantity.repeats.within_sd)},
                {"smallest_change_single", number(quantity.smallest_single)},
                {"changes", Json::array()}};
    for (const SessionChange& change : quantity.changes) {
      one["changes"].push_back({{"from", clean_line(overlay.sessions[change.from].name)},
                                {"to", clean_line(overlay.sessions[change.to].name)},
                                {"mean_from", quantity.means[change.from]},
                                {"mean_to", quantity.means[change.to]},
                                {"change", change.change},
                                {"smallest_change", number(change.smallest)},
                                {"probability", number(change.probability)},
                                {"adjusted_probability", number(change.adjusted_probability)}});
    }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

SessionOverlay overlay_of(std::vector<Session> sessions,
                          const std::vector<ReportSection>& sections) {
  SessionOverlay overlay;
  overlay.motion = compare_sessions(sessions);
  overlay.readings = compare_readings(sessions, sections);
  overlay.sessions = std::move(sessions);
  return overlay;
}

std::string overlay_html(const SessionOverlay& overlay,
                         const std::vector<ReportSection>& sections) {
  std::string text = "<section id=\"sessions\">\n<h2>Sessions</h2>\n<ol>\n";
  for (std::size_t i = 0; i < overlay.sessions.size(); ++i) {
    std::string names;
    for (const RecordingReport& recording : overlay.sessions[i].recordings) {
      names += (names.empty() ? "" : ", ") + recording.source;
    }
    text += fmt::format("<li>{} {}: {}</li>\n", key(i), html_text(overlay.sessions[i].name),
                        html_text(names));
  }
  text +=
      "</ol>\n<p>Points: recordings. Short line: mean of a session. Grey: within it, a mean does "
      "not differ detectably from the first session's (95 %). A difference that repeats within a "
      "session do not show, such as an instrument mounted anew, is part of a change.</p>\n";
  text += overlaid_paths(overlay, sections);
  std::string drawings;
  for (const auto* comparison : {&overlay.readings, &overlay.motion}) {
    for (const QuantityComparison& quantity : comparison->quantities) {
      if (!quantity.withheld.empty()) continue;
      drawings += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                              change_svg(quantity), html_text(quantity.name));
    }
  }
  if (!drawings.empty()) {
    text += "<h3>Changes</h3>\n<div class=\"row small\">" + drawings + "</div>\n";
  }
  text += changes_table(overlay, overlay.readings, "readings", "Changes of readings");
  text += changes_table(overlay, overlay.motion, "motion", "Changes of the estimated motion");
  text += not_compared_table(overlay);
  return text + "</section>\n";
}

Json overlay_json(const SessionOverlay& overlay) {
  return {{"readings", comparison_json(overlay, overlay.readings)},
          {"motion", comparison_json(overlay, overlay.motion)}};
}

}  // namespace condyle::host
