// SPDX-License-Identifier: Apache-2.0
// Vicon CSV, from the line "Trajectories" on, which MakerFile::start follows:
//   100                      or 100,Hz
//   ,,S:LFHD,,,S:RFHD,,
//   Frame,Sub Frame,X,Y,Z,X,Y,Z      or Field #,X,Y,Z
//   ,,mm,mm,mm,mm,mm,mm              (not in old files)
// then rows up to a blank line. Columns such as X' are velocities.
#include <fmt/format.h>

#include <algorithm>

#include "hosted/files/input_error.h"
#include "recordings/csv_columns.h"
#include "recordings/maker_tables.h"

namespace condyle::host {

std::optional<TableFile> read_vicon_csv(const MakerFile& file) {
  const auto& lines = file.start.lines;
  const auto need = [&](bool is_there, std::size_t line, const char* what) {
    if (is_there) return;
    throw InputError(file.place(line), fmt::format("the Vicon file lacks {}", what),
                     "export the trajectories again");
  };
  need(lines.size() >= 3, 0, "the lines after Trajectories");
  const char separator = lines[2].find('\t') != std::string_view::npos  ? '\t'
                         : lines[2].find(';') != std::string_view::npos ? ';'
                                                                        : ',';
  TableFile table;
  table.info.format = "Vicon CSV";
  table.info.kind = SampleKind::one_point;
  table.info.stated.maker = "Vicon";
  const double rate_Hz = file.rate_Hz(file.fields(0, separator)[0], 0);
  const auto names = file.fields(1, separator), axes = file.fields(2, separator);
  need(axes[0].starts_with("Frame") || axes[0].starts_with("Field"), 2, "the line of axes");
  auto units = file.fields(3, separator);
  const bool has_units = std::any_of(units.begin(), units.end(),
                                     [](std::string_view unit) { return metres_in(unit) > 0; });
  if (!has_units) units.clear();
  std::string name, unit = "mm";
  for (std::size_t i = 0; i < axes.size(); ++i) {
    TableColumn column;
    column.name = std::string(axes[i]);
    // Before a name, columns have no point: an empty name stands for a marker without one.
    if (i < names.size() && !names[i].empty()) name = names[i];
    if (const auto axis = axis_of(axes[i])) {
      if (i < units.size() && !units[i].empty()) unit = units[i];
      if (*axis == 0) table.table.names.push_back(name);
      need(!table.table.names.empty(), 2, "X before Y and Z");
      column.name = fmt::format("{} {}", name, axes[i]);
      column.role = TableColumn::Role::coordinate;
      column.coordinate = 3 * (table.table.names.size() - 1) + *axis;
      column.per_SI_unit = 1 / file.metres_each(unit, has_units ? 3 : 0);
      if (*axis == 2) name.clear();
    }
    table.table.columns.push_back(std::move(column));
  }
  need(!table.table.names.empty(), 2, "trajectories");
  table.info.stated.unit = unit;
  if (!has_units) table.info.notes.emplace_back("no units below the axes: read as millimetres");
  const std::size_t header = has_units ? 4 : 3;
  table.table.style = style_of(
      {lines.begin() + static_cast<std::ptrdiff_t>(std::min(header, lines.size())), lines.end()});
  table.table.style.separator = separator;
  if (separator == ',') table.table.style.has_decimal_comma = false;
  table.table.header_lines = header;
  table.table.has_ragged_rows = true;
  table.table.has_zeros_for_missing = true;
  table.table.ends_at_blank_row = true;
  use_rate(table, file, 0, std::nullopt, rate_Hz);
  return table;
}

}  // namespace condyle::host
