// SPDX-License-Identifier: Apache-2.0
// Qualisys TSV of 3D data, with its header: lines of a KEY and its values (NO_OF_FRAMES, FREQUENCY,
// MARKER_NAMES ...), perhaps a line "Frame  Time  A X  A Y  A Z ...", then rows. Positions are in
// millimetres.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"
#include "recordings/csv_columns.h"
#include "recordings/maker_tables.h"

namespace condyle::host {
namespace {

bool is_key(std::string_view word) {
  return word.size() > 2 &&
         std::all_of(
             word.begin(), word.end(),
             [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'; }) &&
         !(word[0] >= '0' && word[0] <= '9');
}

[[noreturn]] void refuse_columns(const std::string& place) {
  throw InputError(place, "its columns are not X, Y and Z of each name in MARKER_NAMES",
                   "export 3D data with these columns alone, without types and residuals");
}

// Whether the `columns` first ones are a frame number and perhaps a time: they increase.
bool counts(const MakerFile& file, std::size_t line, char separator, std::size_t columns) {
  const auto first = file.fields(line, separator), second = file.fields(line + 1, separator);
  if (columns == 0 || second.size() < columns) return true;
  for (std::size_t i = 0; i < columns; ++i) {
    const TextStyle style{separator, first[i].find(',') != std::string_view::npos};
    double before = 0, after = 0;
    if (parse_field(first[i], style, before) != NumberStatus::ok ||
        parse_field(second[i], style, after) != NumberStatus::ok || !(after > before) ||
        (i == 0 && before != std::floor(before))) {
      return false;
    }
  }
  return true;
}

// The names above the columns, as "A X", in the order of the markers.
void check_heads(std::vector<std::string_view> heads, const std::vector<std::string>& names,
                 const std::string& place) {
  while (!heads.empty() && heads.back().empty()) heads.pop_back();
  if (heads.empty()) return;
  if (heads.size() != 3 * names.size()) refuse_columns(place);
  for (std::size_t i = 0; i < heads.size(); ++i) {
    const std::string_view head = heads[i];
    if (head.empty() || axis_of(head.substr(head.size() - 1)) != i % 3) refuse_columns(place);
    const std::string_view name = trim(head.substr(0, head.size() - 1));
    const bool is_of_other =
        name != names[i / 3] && std::find(names.begin(), names.end(), name) != names.end();
    if (is_of_other) refuse_columns(place);
  }
}

}  // namespace

std::optional<TableFile> read_qualisys_tsv(const MakerFile& file) {
  const auto& lines = file.start.lines;
  const char separator = lines[0].find('\t') != std::string_view::npos ? '\t' : ',';
  const auto first_key = file.fields(0, separator)[0];
  if (first_key != "NO_OF_FRAMES" && first_key != "NO_OF_MARKERS" && first_key != "NO_OF_BODIES") {
    return std::nullopt;
  }
  TableFile table;
  table.info.format = "Qualisys TSV";
  table.info.kind = SampleKind::one_point;
  table.info.stated.maker = "Qualisys";
  table.info.stated.unit = "mm";
  const double metres_each = file.metres_each("mm", 0);
  std::optional<double> rate_Hz;
  std::vector<std::string> names;
  std::size_t line = 0;
  for (; line < lines.size(); ++line) {
    const auto fields = file.fields(line, separator);
    const std::string_view value = fields.size() > 1 ? fields[1] : std::string_view();
    double number = 0;
    if (fields[0] == "Frame" || fields[0] == "Time") break;
    if (!is_key(fields[0]) && !(fields.size() == 1 && fields[0].empty())) break;
    if (fields[0] == "FREQUENCY") rate_Hz = file.rate_Hz(value, line);
    if (fields[0] == "NO_OF_FRAMES" && parse_number(value, number) == NumberStatus::ok &&
        number >= 0 && number < 1e15) {
      table.info.stated.frames = static_cast<std::uint64_t>(number);
    }
    if (fields[0] == "DATA_INCLUDED" && value != "3D") {
      throw InputError(
          file.place(line),
          fmt::format("the file holds {} data, not the places of markers", quote(value)),
          "export 3D data from Qualisys Track Manager");
    }
    if (fields[0] == "EVENT" && fields.size() > 3) {
      if (parse_number(fields[3], number) == NumberStatus::ok) {
        table.info.stated.events.push_back({number, std::string(value)});
      }
    }
    if (fields[0] == "MARKER_NAMES") {
      names.assign(fields.begin() + 1, fields.end());
      while (!names.empty() && names.back().empty()) names.pop_back();
    }
  }
  if (!rate_Hz || names.empty()) {
    throw InputError(file.place(0),
                     fmt::format("the header of the Qualisys file lacks {}",
                                 rate_Hz ? "MARKER_NAMES" : "FREQUENCY"),
                     "export 3D data with its header");
  }
  std::optional<std::size_t> frame, time;
  const auto heads = file.fields(line, separator);
  const auto add = [&](const std::string& name) {
    if (name == "Frame") frame = table.table.columns.size();
    if (name == "Time") time = table.table.columns.size();
    table.table.columns.push_back({TableColumn::Role::ignored, 0, 1, name});
  };
  if (!heads.empty() && (heads[0] == "Frame" || heads[0] == "Time")) {
    ++line;
    std::size_t next = 0;
    for (; next < std::min<std::size_t>(heads.size(), 2); ++next) {
      if (heads[next] != "Frame" && heads[next] != "Time") break;
      add(std::string(heads[next]));
    }
    check_heads({heads.begin() + static_cast<std::ptrdiff_t>(next), heads.end()}, names,
                file.place(line - 1));
  } else {
    // Columns before the coordinates have no names then.
    std::size_t fields = heads.size();
    while (fields > 0 && heads[fields - 1].empty() && fields > 3 * names.size()) --fields;
    if (fields > 3 * names.size()) add("Frame");
    if (fields > 3 * names.size() + 1) add("Time");
    if (fields > 3 * names.size() + 2 ||
        !counts(file, line, separator, fields - 3 * names.size())) {
      refuse_columns(file.place(line));
    }
  }
  for (const std::string& name : names) add_point_columns(table.table, name, metres_each);
  table.table.style = style_of({lines.begin() + static_cast<std::ptrdiff_t>(line), lines.end()});
  table.table.style.separator = separator;
  if (separator == ',') table.table.style.has_decimal_comma = false;
  table.table.header_lines = line;
  table.table.has_ragged_rows = true;
  table.table.has_zeros_for_missing = true;
  use_rate(table, file, frame, time, *rate_Hz);
  return table;
}

}  // namespace condyle::host
