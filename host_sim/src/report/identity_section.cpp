// SPDX-License-Identifier: Apache-2.0
#include "report/identity_section.h"

#include <fmt/format.h>

#include "readings/readings_files.h"
#include "report/html_table.h"
#include "report/html_text.h"

namespace condyle::host {
namespace {

std::string files_table(const ReportSection& section, const std::string& prefix) {
  HtmlTable table(prefix, "files", {"file", "name", "SHA-1 of its bytes"});
  for (const FileIdentity& file : section.identity.files) {
    table.begin_row();
    table.cell(file.role);
    table.cell(file.name);
    table.cell(file.sha1.empty() ? "cannot be read again" : file.sha1);
    table.end_row();
  }
  return table.html("Files");
}

std::string landmarks_table(const ReportSection& section, const std::string& prefix) {
  if (!section.landmarks) return {};
  HtmlTable table(prefix, "landmarks", {"landmark", "x (mm)", "y (mm)", "z (mm)", "sd (mm)"});
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    table.begin_row();
    table.cell(Landmarks::kNames[i]);
    for (int axis = 0; axis < 3; ++axis) {
      table.number_cell(rounded(section.landmarks->point_m[i][axis] * 1e3, 2));
    }
    table.number_cell(rounded(section.landmarks->sd_m[i] * 1e3, 2));
    table.end_row();
  }
  return table.html("Landmarks, in the instrument's frame");
}

std::string parameters_table(const ReportSection& section, const std::string& prefix) {
  if (!section.parameters) return {};
  HtmlTable table(prefix, "parameters", {"section", "parameter", "value", "unit"});
  const auto add = [&table](const char* part, const char* key, const std::string& value,
                            const char* unit) {
    table.begin_row();
    table.cell(part);
    table.cell(key);
    table.number_cell(value);
    table.cell(unit);
    table.end_row();
  };
  add("", "lag", std::to_string(section.lag), "samples");
  const auto visit = [&add](const char* part, const char* key, const double* values,
                            std::size_t count, const char* unit, const Range&) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
      text += fmt::format("{}{:g}", i > 0 ? " " : "", values[i]);
    }
    add(part, key, text, unit);
  };
  if (section.impedance) {
    visit_driven_fields(*section.parameters, visit);
  } else {
    visit_motion_fields(*section.parameters, visit);
  }
  return table.html("Parameters of the estimates over time");
}

}  // namespace

std::string identity_html(const ReportSection& section, const std::string& landmarks) {
  std::string text = "<dl>\n";
  const auto add = [&text](const char* term, const std::string& words) {
    text += fmt::format("<dt>{}</dt><dd>{}</dd>\n", term, html_text(words));
  };
  add("recording", section.recording);
  add("format", section.format);
  if (section.identity.session) {
    const SessionIdentity& session = *section.identity.session;
    add("subject", session.subject_code.empty() ? "no code given" : session.subject_code);
    add("session",
        fmt::format("begun {} UTC, recorded by condyle {}", session.begin_utc, session.recorder));
    for (const std::string& device : session.devices) add("device", device);
  }
  if (section.analysis) {
    const Analysis& analysis = *section.analysis;
    add("length",
        fmt::format("{:.1f} s, {:.1f} samples a second", analysis.duration_s, analysis.rate_Hz));
    add("reference position",
        fmt::format("{:.2f} to {:.2f} s, {}", analysis.reference_begin_s, analysis.reference_end_s,
                    analysis.is_reference_found ? "found" : "stated"));
    add("noise", noise_text(analysis));
    add("samples", samples_text(analysis.counts));
    add("range", fmt::format("{:.1f} mm, {:.1f} deg", analysis.largest_displacement_mm,
                             analysis.largest_rotation_deg));
  }
  if (section.landmarks) {
    add("landmarks", fmt::format("{}; condyles {}, plane {}", landmarks,
                                 section.landmarks->condyle_kind, section.landmarks->plane));
  } else {
    add("landmarks", "none: readings of the condyles are withheld");
  }
  return text + "</dl>\n";
}

std::string identity_tables(const ReportSection& section, const std::string& prefix) {
  return "<details><summary>Files, landmarks and parameters</summary>\n" +
         files_table(section, prefix) + landmarks_table(section, prefix) +
         parameters_table(section, prefix) + "</details>\n";
}

}  // namespace condyle::host
