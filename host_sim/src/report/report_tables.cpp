// SPDX-License-Identifier: Apache-2.0
#include "report/report_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "readings/readings_files.h"
#include "report/html_table.h"
#include "report/html_text.h"

namespace condyle::host {
namespace {

std::string task_name(TaskKind kind) {
  return kind == TaskKind::whole ? "whole recording" : name_of(kind);
}

void add_reading(HtmlTable& table, const JawReading& reading, bool has_stroke) {
  const double half = (reading.high - reading.low) / 2;
  const bool is_count = half == 0 && reading.value == std::floor(reading.value);
  const int digits = is_count ? 0 : digits_for(half);
  table.begin_row(name_of(reading.provenance));
  table.cell(task_name(reading.task));
  if (has_stroke) table.number_cell(std::to_string(reading.stroke));
  table.cell(std::string(reading.definition->name));
  table.cell(name_of(reading.side));
  table.number_cell(rounded(reading.value, digits));
  table.number_cell(rounded(reading.low, digits));
  table.number_cell(rounded(reading.high, digits));
  table.cell(reading.definition->unit == "1" ? "" : std::string(reading.definition->unit));
  table.html_cell(provenance_mark(name_of(reading.provenance)));
  table.html_cell(reason_html(reading.reason));
  table.end_row();
}

using NamesOfReason = std::map<std::string, std::set<std::string>>;

// Means of tasks that are withheld.
NamesOfReason withheld_by_reason(const Analysis& analysis) {
  NamesOfReason names;
  for (const JawReading& reading : analysis.readings) {
    if (reading.provenance != ReadingProvenance::withheld || reading.stroke > 0) continue;
    const std::string side = name_of(reading.side);
    names[reading.reason].insert(fmt::format("{} {}{}", task_name(reading.task),
                                             reading.definition->name,
                                             side.empty() ? "" : " (" + side + ")"));
  }
  return names;
}

std::string joined(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : "; ") + name;
  return text;
}

}  // namespace

std::string html_lines(const std::string& text) {
  std::istringstream lines(text);
  std::string result, line;
  while (std::getline(lines, line)) result += html_text(line) + "\n";
  return result;
}

std::string provenance_key() {
  return fmt::format(
      "<p>{} measured: follows from the recording. {} derived: also rests on a named assumption. "
      "{} "
      "assumed: a prior, not the subject. {} withheld: not known.</p>\n",
      provenance_mark("measured"), provenance_mark("derived"), provenance_mark("assumed"),
      provenance_mark("withheld"));
}

std::string task_key(const Analysis& analysis) {
  std::set<std::string> names;
  for (const Task& task : analysis.tasks) {
    names.insert(task.kind == TaskKind::whole ? "whole" : name_of(task.kind));
  }
  std::string text = "<p>";
  for (const std::string& name : names) {
    text += fmt::format(
        "<svg width=\"28\" height=\"8\" aria-hidden=\"true\"><line class=\"{0}\" "
        "stroke-width=\"3\" x1=\"0\" x2=\"28\" y1=\"4\" y2=\"4\"/></svg> {0} ",
        name);
  }
  return text + "</p>\n";
}

std::string tasks_table(const Analysis& analysis, const std::string& prefix) {
  HtmlTable table(prefix, "tasks", {"task", "begin (s)", "end (s)", "source"});
  for (const Task& task : analysis.tasks) {
    table.begin_row();
    table.cell(task_name(task.kind));
    table.number_cell(rounded(task.begin_s, 2));
    table.number_cell(rounded(task.end_s, 2));
    table.cell(task.kind == TaskKind::whole ? "" : task.is_found ? "found" : "stated");
    table.end_row();
  }
  return table.html("Tasks");
}

std::string readings_table(const Analysis& analysis, const std::string& prefix) {
  HtmlTable table(
      prefix, "readings",
      {"task", "reading", "side", "value", "low", "high", "unit", "provenance", "assumption"});
  for (const JawReading& reading : analysis.readings) {
    if (reading.stroke > 0 || reading.provenance == ReadingProvenance::withheld) continue;
    add_reading(table, reading, false);
  }
  return table.html("Readings: means of each task");
}

std::string strokes_table(const Analysis& analysis, const std::string& prefix) {
  HtmlTable table(prefix, "strokes",
                  {"task", "stroke", "reading", "side", "value", "low", "high", "unit",
                   "provenance", "assumption"});
  for (const JawReading& reading : analysis.readings) {
    if (reading.stroke == 0 || reading.provenance == ReadingProvenance::withheld) continue;
    add_reading(table, reading, true);
  }
  const std::string html = table.html("Readings of single strokes");
  if (html.empty()) return {};
  return "<details><summary>Single strokes</summary>\n" + html + "</details>\n";
}

std::string cycles_table(const Analysis& analysis, const std::string& prefix) {
  if (analysis.cycles.empty()) return {};
  const auto names = readings_of_cycle(analysis.has_landmarks);
  std::string text = fmt::format(
      "<div class=\"scroll\" tabindex=\"0\"><table class=\"numbers\" "
      "data-csv=\"{}_cycles\"><thead><tr><th scope=\"col\">cycle</th>"
      "<th scope=\"col\">begin (s)</th>",
      prefix);
  for (const auto name : names) text += fmt::format("<th scope=\"col\">{}</th>", name);
  text +=
      "<th scope=\"col\">not taken</th><th scope=\"col\">assumption</th></tr></thead>\n<tbody>\n";
  for (const AnalysedCycle& cycle : analysis.cycles) {
    text += fmt::format("<tr><td>{}<td>{:.2f}",
                        cycle.number > 0 ? std::to_string(cycle.number) : "", cycle.cycle.begin_s);
    for (std::size_t i = 0; i < names.size(); ++i) {
      std::string value;
      if (i < cycle.values.size() && std::isfinite(cycle.values[i].value)) {
        const double half = cycle.values[i].half_interval();
        const int digits = digits_for(half);
        value = fmt::format("{} \u00b1 {}", rounded(cycle.values[i].value, digits),
                            rounded(half, digits));
      }
      text += fmt::format("<td>{}", value);
    }
    text +=
        fmt::format("<td>{}<td>{}\n", html_text(cycle.cycle.rejected), html_text(cycle.assumed));
  }
  return "<details><summary>Chewing cycles</summary>\n<h3>Chewing cycles</h3>\n" + text +
         "</tbody></table></div></details>\n";
}

std::string withheld_table(const Analysis& analysis, const std::string& prefix) {
  HtmlTable table(prefix, "withheld", {"reason, and what to record", "readings"});
  for (const auto& [reason, readings] : withheld_by_reason(analysis)) {
    table.begin_row("withheld");
    table.html_cell(reason_html(reason));
    table.cell(joined(readings));
    table.end_row();
  }
  const std::string html = table.html("Withheld");
  return html.empty() ? html : fmt::format("<div id=\"{}_withheld\">{}</div>\n", prefix, html);
}

std::string withheld_banner(const Analysis& analysis, const std::string& prefix) {
  constexpr std::size_t kMostReasons = 4;
  const NamesOfReason withheld = withheld_by_reason(analysis);
  if (withheld.empty()) return {};
  std::vector<std::pair<std::string, std::set<std::string>>> sorted(withheld.begin(),
                                                                    withheld.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
  std::size_t count = 0, reasons = 0;
  std::string items;
  for (const auto& [reason, readings] : sorted) {
    count += readings.size();
    if (++reasons > kMostReasons) continue;
    items += fmt::format("<li>{}: {}</li>\n", html_text(joined(readings)), reason_html(reason));
  }
  return fmt::format(
      "<div class=\"banner\"><strong>{} {} withheld</strong><ul>\n{}</ul>\n"
      "<a href=\"#{}_withheld\">All that is withheld, and what to record</a></div>\n",
      count, count == 1 ? "reading is" : "readings are", items, prefix);
}

std::string definitions_table(const std::vector<ReportSection>& sections) {
  std::set<std::string> shown;
  for (const ReportSection& section : sections) {
    if (!section.analysis) continue;
    for (const JawReading& reading : section.analysis->readings) {
      if (reading.provenance == ReadingProvenance::withheld) continue;
      shown.insert(std::string(reading.definition->name));
    }
  }
  HtmlTable table("report", "definitions", {"reading", "unit", "definition", "publication"});
  for (const std::string& name : shown) {
    const ReadingDefinition& definition = definition_of(name);
    table.begin_row();
    table.cell(name);
    table.cell(std::string(definition.unit));
    table.cell(std::string(definition.definition));
    table.cell(std::string(reference_of(definition)));
    table.end_row();
  }
  return table.html("Definitions of the readings shown");
}

}  // namespace condyle::host
