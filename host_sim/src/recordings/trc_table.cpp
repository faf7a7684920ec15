// SPDX-License-Identifier: Apache-2.0
// TRC (Motion Analysis):
//   PathFileType  4  (X/Y/Z)  FILE
//   DataRate  CameraRate  NumFrames  NumMarkers  Units ...
//   100       100         652        3           mm
//   Frame#  Time  NAME      NAME ...     a name stands above three columns
//                 X1 Y1 Z1  X2 Y2 Z2
// then rows, also after a blank line. Programs separate by tabs, commas or blanks, leave out empty
// fields at the end of a row, and some state a wrong number of markers: the names count.
#include <fmt/format.h>

#include <algorithm>

#include "hosted/files/input_error.h"
#include "recordings/maker_tables.h"

namespace condyle::host {
namespace {

struct Names {
  std::vector<std::string> of_points;
  bool are_compact = false;  // one field a name, not three
};

Names names_of(const std::vector<std::string_view>& fields) {
  Names names;
  std::size_t last = 0;
  bool are_in_threes = true;
  for (std::size_t i = 2; i < fields.size(); ++i) {
    if (fields[i].empty()) continue;
    last = i;
    are_in_threes = are_in_threes && (i - 2) % 3 == 0;
  }
  if (last == 0) return names;
  names.are_compact = !are_in_threes;
  for (std::size_t i = 2; i <= last; i += names.are_compact ? 1 : 3) {
    names.of_points.emplace_back(fields[i]);
  }
  return names;
}

}  // namespace

std::optional<TableFile> read_trc(const MakerFile& file) {
  const auto& lines = file.start.lines;
  if (!lines[0].starts_with("PathFileType")) return std::nullopt;
  const auto need = [&](bool is_there, std::size_t line, const char* what) {
    if (is_there) return;
    throw InputError(file.place(line), fmt::format("the header of the TRC file lacks {}", what),
                     "export the recording again");
  };
  need(lines.size() >= 5, std::min<std::size_t>(lines.size(), 4), "one of its five lines");
  char separator = ' ';
  for (const char candidate : {'\t', ',', ';'}) {
    if (separator == ' ' && lines[1].find(candidate) != std::string_view::npos) {
      separator = candidate;
    }
  }
  const auto keys = file.fields(1, separator), values = file.fields(2, separator);
  const auto value_of = [&](std::string_view key) -> std::string_view {
    for (std::size_t i = 0; i < keys.size() && i < values.size(); ++i) {
      if (keys[i] == key) return values[i];
    }
    return {};
  };
  TableFile table;
  table.info.format = "TRC";
  table.info.kind = SampleKind::one_point;
  table.info.stated.unit = std::string(value_of("Units"));
  const double metres_each = file.metres_each(value_of("Units"), 2);
  const double rate_Hz = file.rate_Hz(value_of("DataRate"), 2);
  double stated_markers = 0, stated_frames = 0;
  const bool states_markers =
      parse_number(value_of("NumMarkers"), stated_markers) == NumberStatus::ok;
  if (parse_number(value_of("NumFrames"), stated_frames) == NumberStatus::ok &&
      stated_frames >= 0 && stated_frames < 1e15) {
    table.info.stated.frames = static_cast<std::uint64_t>(stated_frames);
  }
  const auto heads = file.fields(3, separator);
  need(heads.size() >= 2 && heads[0].starts_with("Frame"), 3, "the line Frame# Time");
  const Names names = names_of(heads);
  table.table.columns = {{TableColumn::Role::ignored, 0, 1, "Frame#"},
                         {TableColumn::Role::ignored, 0, 1, "Time"}};
  for (const std::string& name : names.of_points) {
    add_point_columns(table.table, name, metres_each);
  }
  if (states_markers && static_cast<double>(names.of_points.size()) != stated_markers) {
    table.info.notes.push_back(fmt::format("its header states {:g} markers and names {}",
                                           stated_markers, names.of_points.size()));
  }
  std::size_t header = 5;
  table.table.style = style_of(
      {lines.begin() + 5,
       lines.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(lines.size(), 25))});
  table.table.style.separator = separator;
  if (separator == ',') table.table.style.has_decimal_comma = false;
  while (header < lines.size() && is_blank_row(lines[header], separator)) ++header;
  table.table.header_lines = header;
  table.table.has_ragged_rows = true;
  table.table.has_zeros_for_missing = true;
  const std::size_t fields = file.fields(header, separator).size();
  if (fields > table.table.columns.size() + 1) {
    table.info.notes.push_back(
        fmt::format("{} columns without a name are not read", fields - table.table.columns.size()));
  }
  use_rate(table, file, 0, 1, rate_Hz);
  return table;
}

}  // namespace condyle::host
