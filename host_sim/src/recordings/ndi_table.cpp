// SPDX-License-Identifier: Apache-2.0
// NDI First Principles (Optotrak, Polaris), 3D data as text:
//   Number of frames: 500
//   Frequency: 50
//   Units: mm
//
//   Frame  A x  A y  A z  B x ...
// Rows may end with a separator. A missing place is empty or -3.697314e28.
#include <fmt/format.h>

#include <algorithm>

#include "hosted/files/input_error.h"
#include "recordings/csv_columns.h"
#include "recordings/maker_tables.h"

namespace condyle::host {
namespace {

// The value of "KEY: VALUE" or "KEY<separator>VALUE".
std::optional<std::string_view> value_of(std::string_view line, std::string_view key) {
  line = trim(line);
  const bool is_key = line.size() > key.size() &&
                      std::equal(key.begin(), key.end(), line.begin(),
                                 [](char a, char b) { return (a | 0x20) == (b | 0x20); });
  if (!is_key) return std::nullopt;
  line.remove_prefix(key.size());
  const std::size_t begin = line.find_first_not_of(":=,;\t ");
  return begin == std::string_view::npos ? std::string_view() : trim(line.substr(begin));
}

}  // namespace

std::optional<TableFile> read_ndi_text(const MakerFile& file) {
  constexpr std::size_t kMostLines = 40;
  const auto& lines = file.start.lines;
  if (!value_of(lines[0], "Number of frames")) return std::nullopt;
  TableFile table;
  table.info.format = "NDI text";
  table.info.kind = SampleKind::one_point;
  table.info.stated.maker = "NDI";
  std::optional<double> rate_Hz;
  std::string_view unit;
  std::size_t unit_line = 0, line = 0;
  for (; line < std::min(lines.size(), kMostLines); ++line) {
    if (trim(lines[line]).starts_with("Frame") &&
        lines[line].find_first_of("\t,;") != std::string_view::npos) {
      break;
    }
    double frames = 0;
    if (const auto value = value_of(lines[line], "Number of frames")) {
      if (parse_number(*value, frames) == NumberStatus::ok && frames >= 0 && frames < 1e15) {
        table.info.stated.frames = static_cast<std::uint64_t>(frames);
      }
    } else if (const auto frequency = value_of(lines[line], "Frequency")) {
      rate_Hz = file.rate_Hz(*frequency, line);
    } else if (const auto units = value_of(lines[line], "Units")) {
      unit = *units;
      unit_line = line;
    }
  }
  if (!rate_Hz || line == std::min(lines.size(), kMostLines)) {
    throw InputError(file.place(0),
                     fmt::format("the header of the NDI file lacks {}",
                                 rate_Hz ? "the line that begins with Frame" : "Frequency"),
                     "export 3D data with its header");
  }
  const double metres_each = file.metres_each(unit, unit_line);
  table.info.stated.unit = std::string(unit);
  std::string_view names = lines[line];
  const char separator = names.find('\t') != std::string_view::npos  ? '\t'
                         : names.find(';') != std::string_view::npos ? ';'
                                                                     : ',';
  std::vector<std::string> points;
  std::vector<bool> has_axis;  // three a point
  for (const std::string_view name : file.fields(line, separator)) {
    TableColumn column;
    column.name = std::string(name);
    const ColumnMeaning meaning = meaning_of(name, "", "");
    if (meaning.quantity == ColumnMeaning::Quantity::point) {
      const bool differs = meaning.each > 0 ? meaning.each != metres_each : !meaning.unit.empty();
      if (differs && !file.options.units_per_metre) {
        throw InputError(file.place(line),
                         fmt::format("the column {} is in {}, the header states {}", quote(name),
                                     quote(meaning.unit), quote(unit)),
                         "give both in one unit");
      }
      // Programs sort by marker, or by axis.
      std::size_t point = 0;
      while (point < points.size() &&
             (points[point] != meaning.point || has_axis[3 * point + meaning.axis])) {
        ++point;
      }
      if (point == points.size()) {
        points.push_back(meaning.point);
        has_axis.resize(3 * points.size());
      }
      has_axis[3 * point + meaning.axis] = true;
      column.role = TableColumn::Role::coordinate;
      column.coordinate = 3 * point + meaning.axis;
      column.per_SI_unit = 1 / metres_each;
    }
    table.table.columns.push_back(std::move(column));
  }
  if (points.empty()) {
    throw InputError(file.place(line), "no column is a coordinate of a marker",
                     "export 3D data, whose columns are named like 'Marker_1 x'");
  }
  if (const auto lacking = std::find(has_axis.begin(), has_axis.end(), false);
      lacking != has_axis.end()) {
    throw InputError(
        file.place(line),
        fmt::format("the marker {} has not all of x, y and z",
                    quote(points[static_cast<std::size_t>(lacking - has_axis.begin()) / 3])),
        "export 3D data, with three columns a marker");
  }
  table.table.names = std::move(points);
  table.table.style = style_of({lines.begin() + static_cast<std::ptrdiff_t>(line), lines.end()});
  table.table.style.separator = separator;
  if (separator == ',') table.table.style.has_decimal_comma = false;
  table.table.header_lines = line + 1;
  table.table.has_ragged_rows = true;
  table.table.has_zeros_for_missing = true;
  use_rate(table, file, 0, std::nullopt, *rate_Hz);
  return table;
}

}  // namespace condyle::host
