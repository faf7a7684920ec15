// SPDX-License-Identifier: Apache-2.0
#include "report/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "report/average_cycle_section.h"
#include "report/html_text.h"
#include "report/identity_section.h"
#include "report/impedance_section.h"
#include "report/page_text.h"
#include "report/plane_drawing.h"
#include "report/report_tables.h"
#include "report/sample_times_section.h"
#include "report/task_paths.h"

namespace condyle::host {
namespace {

std::string paragraph(const std::string& text) {
  return fmt::format("<p>{}</p>\n", html_text(text));
}

std::string list(const std::vector<std::string>& items) {
  std::string text = "<ul>\n";
  for (const std::string& item : items) text += fmt::format("<li>{}</li>\n", html_text(item));
  return text + "</ul>\n";
}

std::string figure(const std::string& content, const std::string& caption) {
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", content,
                     html_text(caption));
}

std::string banner(const char* kind, const std::string& title,
                   const std::vector<std::string>& items) {
  return fmt::format("<div class=\"banner {}\"><strong>{}</strong>{}</div>\n", kind,
                     html_text(title), items.empty() ? "" : list(items));
}

// What a reader must know before any number.
std::string banners(const ReportSection& section, const std::string& prefix) {
  std::string text;
  if (!section.no_readings.empty()) {
    text += banner("bad", "No readings: " + section.no_readings, {});
  } else if (!section.analysis->unusable.empty()) {
    text += banner("bad", "Readings are withheld: " + section.analysis->unusable, {});
  } else {
    text += withheld_banner(*section.analysis, prefix);
  }
  if (!section.warnings.empty()) {
    text += banner("", "Warnings about the estimates", section.warnings);
  }
  std::vector<std::string> problems = section.notes;
  if (section.analysis) {
    for (const auto* some : {&section.analysis->notes, &section.analysis->events}) {
      problems.insert(problems.end(), some->begin(), some->end());
    }
  }
  if (!problems.empty()) text += banner("", "Notes on the recording", problems);
  return text;
}

std::string chart(const char* key, const std::string& title) {
  return fmt::format("<div data-chart=\"{}\" role=\"img\" aria-label=\"{} over time\"></div>\n",
                     key, title);
}

std::string charts(const ReportSection& section) {
  if (section.series.runs().empty()) return {};
  std::string text = "<h3>Over time</h3>\n";
  text += paragraph(
      "Bands are 95 % intervals. Dotted curves are assumed. Shaded times are tasks, red ticks "
      "unusual "
      "samples. The cursor is "
      "the same in all views. Drag to enlarge a time, double-click to see all. Keys: arrows, Home "
      "and End move the cursor; + and - zoom; 0 shows all.");
  if (section.series.axis_count() > 1) {
    text += paragraph("x, y and z: the followed point, in the instrument's frame.");
  }
  if (section.origin_s != 0) {
    text +=
        paragraph(fmt::format("Time 0 is {:.3f} s on the recording's clock.", section.origin_s));
  }
  text +=
      "<div class=\"controls sticky\" role=\"group\" aria-label=\"Moment and span\">"
      "<button type=\"button\" data-do=\"play\">Play</button>"
      "<input type=\"range\" step=\"any\" aria-label=\"Moment\"><output></output><output></output>"
      "<button type=\"button\" data-do=\"zoom-in\">Zoom in</button>"
      "<button type=\"button\" data-do=\"zoom-out\">Zoom out</button>"
      "<button type=\"button\" data-do=\"zoom-all\">Whole recording</button></div>\n"
      "<div class=\"charts\" tabindex=\"0\" role=\"group\" aria-label=\"Charts over time\">\n";
  constexpr const char* kKeys[ReportSeries::kCharts] = {"position", "velocity", "acceleration",
                                                        "friction", "mass"};
  for (std::size_t i = 0; i < ReportSeries::kCharts; ++i) {
    if (section.series.provenance(static_cast<ReportSeries::Chart>(i)) ==
        Provenance::not_computed) {
      continue;
    }
    text += chart(kKeys[i], kKeys[i]);
  }
  text += "</div>\n";
  if (section.impedance) return text;
  text += paragraph(
      "Force is left out: it is the acceleration times a mass that position does not determine.");
  text += paragraph(
      "Friction and mass are left out: to know them, record the total drive with the motion.");
  return text;
}

// Of the chords: paper cannot show what hovering shows.
std::string angles_in_words(const PlaneDrawing& drawing) {
  std::string words;
  for (const DrawnAngle& angle : drawing.angles) {
    words += (words.empty() ? ". By task: " : "; ") + angle.label;
  }
  return words;
}

std::string paths(const ReportSection& section) {
  const Analysis& analysis = *section.analysis;
  if (!analysis.unusable.empty() || analysis.path.time_s.empty()) return {};
  std::string text = analysis.has_landmarks ? "<h3>Path of the lower incisor</h3>\n"
                                            : "<h3>Path of point 1</h3>\n";
  text += "<div class=\"tasks\"><div class=\"row\">";
  const TaskPaths incisor = task_paths(analysis, analysis.path.incisor_m);
  for (const PlaneDrawing& drawing : incisor_drawings(analysis.has_landmarks)) {
    text += figure(plane_svg(drawing, incisor.paths), drawing.title);
  }
  text += "</div>\n" + task_key(analysis) + "</div>\n";
  const std::string missing = what_is_missing(incisor);
  if (!missing.empty()) text += paragraph(missing);
  if (!analysis.has_landmarks) {
    return text +
           paragraph(
               "Condyles are left out: state their places with --landmarks FILE to see their "
               "paths.");
  }
  text += "<h3>Paths of the condyles</h3>\n<div class=\"tasks\"><div class=\"row pairs\">";
  for (const PlaneDrawing& drawing : condyle_drawings(analysis)) {
    text += figure(plane_svg(drawing, task_paths(analysis, *drawing.path_m).paths),
                   drawing.title + angles_in_words(drawing));
  }
  text += "</div>\n" + task_key(analysis) + "</div>\n";
  text += paragraph("Black dashes: chord of each angle at its travel. Grey: its 95 % interval.");
  text +=
      "<h3>The jaw</h3>\n<div><canvas class=\"jaw\" tabindex=\"0\" "
      "aria-label=\"The jaw in three dimensions; arrow keys turn it\"></canvas></div>\n";
  text += paragraph("The lines between the condyles and the incisor are a sketch.");
  return text;
}

std::string section_html(const ReportSection& section, const std::string& landmarks,
                         std::size_t number) {
  std::string text = fmt::format("<section id=\"recording-{}\">\n<h2>{}</h2>\n", number,
                                 html_text(section.recording));
  const std::string prefix = fmt::format("recording_{}", number);
  text += banners(section, prefix) + identity_html(section, landmarks) +
          identity_tables(section, prefix);
  text += sample_times_html(
      section.analysis ? section.analysis->path.time_s : section.sample_times_s, section.origin_s);
  text += charts(section) + impedance_html(section, prefix);
  if (section.analysis) {
    const Analysis& analysis = *section.analysis;
    text += paths(section) + average_cycle_html(analysis, prefix) + tasks_table(analysis, prefix) +
            readings_table(analysis, prefix) + strokes_table(analysis, prefix) +
            cycles_table(analysis, prefix) + withheld_table(analysis, prefix);
  }
  if (!section.summary.empty()) {
    text +=
        fmt::format("<details><summary>The estimates in words</summary><pre>{}</pre></details>\n",
                    html_lines(section.summary));
  }
  return text + "</section>\n";
}

std::string head() {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "script-src '{}'; style-src '{}'; img-src data:; base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>condyle report</title>\n<style>{}</style>\n</head>\n",
      kPageScriptHash, kPageStyleHash, kPageStyle);
}

}  // namespace

std::string report_page(const std::vector<ReportSection>& sections, const std::string& landmarks,
                        const SessionOverlay* overlay) {
  std::string text = head() + "<body>\n<header>\n<h1>Jaw motion report</h1>\n";
  text += fmt::format(
      "<div class=\"banner\"><strong>Research use only; not a diagnosis.</strong> condyle {}. "
      "Every reading and every estimate has a 95 % interval, or is withheld with the reason."
      "</div>\n",
      CONDYLE_VERSION);
  text += provenance_key();
  text +=
      "<p class=\"screen\"><label><input type=\"checkbox\" id=\"decimal-comma\"> Decimal comma in "
      "saved tables</label></p>\n</header>\n";
  if (sections.size() > 1) {
    text += "<nav aria-label=\"Recordings\"><ul>\n";
    if (overlay != nullptr) text += "<li><a href=\"#sessions\">Sessions</a></li>\n";
    for (std::size_t i = 0; i < sections.size(); ++i) {
      text += fmt::format("<li><a href=\"#recording-{}\">{}</a></li>\n", i + 1,
                          html_text(sections[i].recording));
    }
    text += "</ul></nav>\n";
  }
  text += "<main>\n";
  if (overlay != nullptr) text += overlay_html(*overlay, sections);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    text += section_html(sections[i], landmarks, i + 1);
  }
  text += definitions_table(sections) + "</main>\n";
  text += fmt::format(
      "<footer><details><summary>Licence of uPlot, which draws the charts</summary><pre>{}"
      "</pre></details></footer>\n",
      html_lines(kPageLicence));
  text += fmt::format("<script type=\"application/json\" id=\"condyle-report-1\">{}</script>\n",
                      report_data(sections, overlay));
  text += fmt::format("<script>{}</script>\n</body>\n</html>\n", kPageScript);
  return text;
}

}  // namespace condyle::host
