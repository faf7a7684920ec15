// SPDX-License-Identifier: Apache-2.0
#include "recordings/maker_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hosted/files/input_error.h"
#include "recordings/csv_columns.h"
#include "recordings/csv_units.h"
#include "recordings/file_units.h"
#include "recordings/utf8_name.h"

namespace condyle::host {
namespace {

// A time has at least three decimals in these formats; a lost frame is a whole step.
constexpr double kRounding_s = 2e-3, kSameRate = 0.01;

// The sections of a Vicon file before its trajectories.
constexpr std::array<std::string_view, 7> kViconSections{
    "Devices", "Joints", "Model Outputs", "Segments", "Events", "Trajectories", "Marker Gaps"};

bool is_section(std::string_view line, std::string_view name) {
  line = trim(line.substr(0, line.find_first_of(",\t;")));
  return line.size() == name.size() &&
         std::equal(line.begin(), line.end(), name.begin(), [](char a, char b) {
           return (a | 0x20) == (b | 0x20);  // letters and blanks only
         });
}

bool is_vicon(std::string_view line) {
  return std::any_of(kViconSections.begin(), kViconSections.end(),
                     [line](std::string_view name) { return is_section(line, name); });
}

void refuse_opensim(const MakerFile& file) {
  constexpr std::size_t kMostLines = 60;
  bool has_size = false;
  const auto& lines = file.start.lines;
  for (std::size_t i = 0; i < std::min(lines.size(), kMostLines); ++i) {
    std::string_view line = lines[i];
    line = trim(line.substr(0, line.find_first_of(",;\t")));
    has_size = has_size || line.starts_with("nRows") || line.starts_with("datarows") ||
               line.starts_with("nColumns") || line.starts_with("datacolumns") ||
               line.starts_with("DataRate=") || line.starts_with("DataType=");
    if (line != "endheader" || !has_size) continue;
    throw InputError(file.path,
                     "is an OpenSim MOT or STO file: its columns are angles, forces or states of a "
                     "model, not places of markers",
                     "give the recording of the markers, such as TRC or C3D");
  }
}

// Refuses points where no jaw is, which would all count as missing.
void refuse_far(const TableFile& table, const MakerFile& file) {
  constexpr std::size_t kMostRows = 1000;
  std::vector<std::vector<double>> values_m(3 * table.table.names.size());
  const auto& lines = file.start.lines;
  const std::size_t first = table.table.header_lines;
  std::vector<std::string_view> fields;
  for (std::size_t i = first; i < std::min(lines.size(), first + kMostRows); ++i) {
    split_fields(lines[i], table.table.style.separator, fields);
    for (std::size_t k = 0; k < std::min(fields.size(), table.table.columns.size()); ++k) {
      const TableColumn& column = table.table.columns[k];
      double value = 0;
      if (column.role != TableColumn::Role::coordinate || column.coordinate >= values_m.size() ||
          parse_field(fields[k], table.table.style, value) != NumberStatus::ok ||
          is_missing_coordinate(value, 1 / column.per_SI_unit)) {
        continue;
      }
      values_m[column.coordinate].push_back(value / column.per_SI_unit);
    }
  }
  if (const std::string problem = problem_of_distance(values_m); !problem.empty()) {
    throw InputError(
        file.path,
        fmt::format("states its positions in {}: {}", quote(table.info.stated.unit), problem),
        "give --unit mm or --unit m, the unit that is right");
  }
}

}  // namespace

std::string MakerFile::place(std::size_t index) const {
  return fmt::format("{}:{}", path, first_line + index + 1);
}

std::vector<std::string_view> MakerFile::fields(std::size_t index, char separator) const {
  std::vector<std::string_view> fields;
  if (index < start.lines.size()) split_fields(start.lines[index], separator, fields);
  return fields;
}

double MakerFile::rate_Hz(std::string_view text, std::size_t index) const {
  double rate = 0;
  text = trim(text.substr(0, text.find("Hz")));
  const TextStyle style{';', text.find(',') != std::string_view::npos};
  if (parse_field(text, style, rate) != NumberStatus::ok || !(rate >= 1e-3 && rate <= 1e6)) {
    throw InputError(place(index), fmt::format("the rate {} is not a usable number", quote(text)),
                     "give it in Hz");
  }
  return rate;
}

double MakerFile::metres_each(std::string_view unit, std::size_t index) const {
  if (options.units_per_metre) return 1 / *options.units_per_metre;
  if (const double each = metres_in(unit); each > 0) return each;
  throw InputError(
      place(index),
      trim(unit).empty()
          ? std::string("the file does not state the unit of its positions")
          : fmt::format("the unit {} of the positions is not known", quote(trim(unit))),
      "give --unit mm or --unit m");
}

void use_rate(TableFile& table, const MakerFile& file, std::optional<std::size_t> frame,
              std::optional<std::size_t> time, double rate_Hz) {
  constexpr std::size_t kLooked = 1000;
  std::vector<std::string_view> fields;
  std::vector<double> frames, times;
  const auto& lines = file.start.lines;
  for (std::size_t i = table.table.header_lines; i < lines.size() && times.size() < kLooked; ++i) {
    if (is_blank_row(lines[i], table.table.style.separator)) continue;
    split_fields(lines[i], table.table.style.separator, fields);
    const auto value_of = [&](std::optional<std::size_t> column) {
      double value = 0;
      const bool is_number =
          column && *column < fields.size() &&
          parse_field(fields[*column], table.table.style, value) == NumberStatus::ok;
      return is_number ? value : std::nan("");
    };
    frames.push_back(value_of(frame));
    times.push_back(value_of(time));
  }
  // Frame numbers must count.
  bool counts = frame.has_value();
  for (std::size_t i = 1; i < frames.size(); ++i) counts = counts && frames[i] > frames[i - 1];
  const auto column = [&](std::size_t index) -> TableColumn& { return table.table.columns[index]; };
  bool follows = true;
  if (time && times.size() > 1 && std::isfinite(times.back() - times.front())) {
    const double steps =
        counts ? frames.back() - frames.front() : static_cast<double>(times.size() - 1);
    const double expected_s = steps / rate_Hz, stated = times.back() - times.front();
    const auto follows_in = [&](double each) {
      return std::abs(stated * each - expected_s) <= kRounding_s + kSameRate * expected_s;
    };
    follows = follows_in(1);
    const TimesDoubt doubt = doubt_of_times(times, 1);
    if (!follows && doubt.each > 0 && follows_in(doubt.each)) {
      table.info.notes.push_back(
          fmt::format("its times are in {}, by its rate of {:g} Hz", doubt.unit, rate_Hz));
      time.reset();
      follows = true;
    } else if (!follows) {
      table.info.notes.push_back(
          fmt::format("its times do not follow its rate of {:g} Hz: the times are used", rate_Hz));
    }
  }
  if (!follows) {
    column(*time).role = TableColumn::Role::time;
    return;
  }
  table.table.rate_Hz = rate_Hz;
  if (counts) column(*frame).role = TableColumn::Role::frame;
  if (time) column(*time).role = TableColumn::Role::first_time;
}

std::unique_ptr<NamedPointsRecording> open_maker_table(std::unique_ptr<ByteReader>& reader,
                                                       const RecordingOptions& options) {
  constexpr std::array kFormats{read_trc, read_qualisys_tsv, read_motive_csv, read_ndi_text,
                                read_motion_bids};
  const std::string path = reader->path();
  MakerFile file{start_of(*reader), path, options};
  if (file.start.lines.empty()) return nullptr;
  refuse_opensim(file);
  std::optional<TableFile> table;
  for (const auto& read : kFormats) {
    if (!table) table = read(file);
  }
  if (!table && is_vicon(file.start.lines[0])) {
    // The sections before may be longer than what was looked at.
    std::string_view line;
    while (true) {
      const std::string_view next = reader->peek(64);
      if (is_section(next.substr(0, next.find('\n')), "Trajectories")) break;
      if (!reader->next_line(line)) {
        throw InputError(path, "is a Vicon CSV file without the section Trajectories",
                         "export the trajectories");
      }
    }
    static_cast<void>(reader->next_line(line));
    file.first_line = static_cast<std::size_t>(reader->line_number());
    file.start = start_of(*reader);
    table = read_vicon_csv(file);
  }
  if (!table) return nullptr;
  use_given_unit(options.units_per_metre, table->info);
  for (std::string& name : table->table.names) name = utf8_name(std::move(name));
  refuse_far(*table, file);
  if (!options.columns.empty() || !options.ignored_columns.empty()) {
    throw InputError(path,
                     fmt::format("{} applies only to CSV",
                                 options.columns.empty() ? "--ignore-column" : "--columns"),
                     "leave it out; --marker chooses points");
  }
  if (options.rate_Hz && table->table.rate_Hz != options.rate_Hz) {
    throw InputError(path, "--rate-Hz is given, and the file states its rate or times",
                     "leave it out");
  }
  return open_table(std::move(reader), std::move(*table), options);
}

}  // namespace condyle::host
