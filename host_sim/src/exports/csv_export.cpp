// SPDX-License-Identifier: Apache-2.0
// CSV in two shapes. Long: one value in a row, with its unit and provenance, as R and pandas take
// it. Wide: one sample in a row, as spreadsheets and condyle itself take it.
#include <fmt/format.h>

#include <cmath>

#include "exports/export_format.h"
#include "exports/export_text.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

std::string field(const std::string& text, const TableForm& form) {
  const bool needs_marks = text.find(form.separator()) != std::string::npos;
  return needs_marks ? csv_cell(text) : csv_field(text);
}

// Appends a number, nothing for a missing one.
void append_value(std::string& row, double value, double per_SI_unit, const TableForm& form) {
  if (!std::isfinite(value)) return;
  const std::size_t begin = row.size();
  append_scaled(row, value, per_SI_unit);
  form.localise(row, begin);
}

void append_time(std::string& row, TimeNs time_ns, const TableForm& form) {
  const std::size_t begin = row.size();
  append_time_s(row, time_ns);
  form.localise(row, begin);
}

// A file of its own for events, which have no value.
void write_events(const ExportData& data, const TableForm& form, const std::string& out,
                  Exported& result) {
  if (data.events.empty()) return;
  if (out == "-") {
    result.notes.push_back(fmt::format("{} events are left out: the standard output takes one file",
                                       data.events.size()));
    return;
  }
  const std::string stem = out.ends_with(".csv") ? out.substr(0, out.size() - 4) : out;
  result.files.push_back(std::make_unique<OutputFile>(stem + ".events.csv"));
  OutputFile& file = *result.files.back();
  file.write(fmt::format("time_s{}name\n", form.separator()));
  for (const NamedInstant& event : data.events) {
    std::string row;
    append_time(row, nanoseconds(event.time_s), form);
    file.write(row + form.separator() + field(event.name, form) + "\n");
  }
  file.close();
}

// The end of a column's name: "_x_mm", "_qw", "_velocity_x_mm_s" of an estimate.
std::string column_ending(const ExportSeries& series, const std::string& component,
                          const std::string& unit) {
  if (series.quantity == "orientation") return "_q" + component;
  std::string ending = has_several_quantities(series) ? "_" + series.quantity : "";
  if (!component.empty()) ending += "_" + component;
  std::string words = unit;
  for (char& c : words) c = c == '/' || c == '^' ? '_' : c;
  return words.empty() ? ending : ending + "_" + words;
}

}  // namespace

Exported export_long_csv(const ExportData& data, const TableForm& form, const std::string& out) {
  Exported result;
  result.files.push_back(std::make_unique<OutputFile>(out));
  OutputFile& file = *result.files.back();
  const char separator = form.separator();
  const double per_metre = form.lengths_per_m(1000);
  std::string row = "time_s";
  for (const char* name : {"name", "quantity", "component", "value", "unit", "provenance"}) {
    (row += separator) += name;
  }
  file.write(row += '\n');
  const auto write = [&](TimeNs time_ns, const std::string& what, double value, double per_SI_unit,
                         const std::string& end, const char* provenance) {
    row.clear();
    append_time(row, time_ns, form);
    row += what;
    append_value(row, value, per_SI_unit, form);
    row += end;
    row += std::isfinite(value) ? provenance : "missing";
    file.write(row += '\n');
  };
  struct Column {
    const ExportSeries* series;
    std::size_t component;
    WrittenUnit unit;
    std::string what, end;
  };
  std::vector<Column> columns;
  for (const ExportSeries& series : data.series) {
    const WrittenUnit unit = written_unit(series.unit, per_metre);
    for (std::size_t i = 0; i < series.components.size(); ++i) {
      columns.push_back({&series, i, unit,
                         separator + field(series.name, form) + separator +
                             field(series.quantity, form) + separator +
                             field(series.components[i], form) + separator,
                         separator + field(unit.name, form) + separator});
    }
  }
  for (std::size_t k = 0; k < data.samples(); ++k) {
    for (const Column& column : columns) {
      write(data.time_ns[k], column.what, column.series->at(k)[column.component],
            column.unit.per_SI_unit, column.end,
            provenance_name(column.series->provenance_at(k, column.component)));
    }
  }
  for (const ExportChannel& channel : data.channels) {
    const std::string what = separator + field(channel.channel.name, form) + separator +
                             "analogue" + separator + separator;
    const std::string end = separator + field(channel.channel.unit, form) + separator;
    for (std::size_t k = 0; k < channel.values.size(); ++k) {
      const double time_s = channel.first_s + static_cast<double>(k) / channel.channel.rate_Hz;
      write(nanoseconds(time_s), what, channel.values[k], 1, end, "measured");
    }
  }
  file.close();
  write_events(data, form, out, result);
  return result;
}

Exported export_wide_csv(const ExportData& data, const TableForm& form, const std::string& out) {
  Exported result;
  result.files.push_back(std::make_unique<OutputFile>(out));
  OutputFile& file = *result.files.back();
  const double per_metre = form.lengths_per_m(1000);
  std::string row = "time_s";
  for (const ExportSeries& series : data.series) {
    const WrittenUnit unit = written_unit(series.unit, per_metre);
    for (const std::string& component : series.components) {
      row += form.separator();
      row += field(series.name + column_ending(series, component, unit.name), form);
    }
    if (series.provenances.empty()) continue;
    for (const std::string& component : series.components) {
      row += form.separator();
      row += field(series.name + column_ending(series, component, "provenance"), form);
    }
  }
  file.write(row += '\n');
  for (std::size_t k = 0; k < data.samples(); ++k) {
    row.clear();
    append_time(row, data.time_ns[k], form);
    for (const ExportSeries& series : data.series) {
      const double per_SI_unit = written_unit(series.unit, per_metre).per_SI_unit;
      for (std::size_t i = 0; i < series.components.size(); ++i) {
        append_value(row += form.separator(), series.at(k)[i], per_SI_unit, form);
      }
      for (std::size_t i = 0; i < series.components.size() && !series.provenances.empty(); ++i) {
        (row += form.separator()) += provenance_name(series.provenance_at(k, i));
      }
    }
    file.write(row += '\n');
  }
  file.close();
  write_events(data, form, out, result);
  for (const ExportSeries& series : data.series) {
    if (series.provenance == Provenance::measured || has_several_quantities(series)) continue;
    result.notes.push_back(
        "the wide table has no place for provenance: the long one (csv) states it");
    break;
  }
  const std::string left_out =
      note_on_left_out(data, false, true, [](const ExportSeries&) { return true; });
  if (!left_out.empty()) result.notes.push_back(left_out);
  return result;
}

}  // namespace condyle::host
