// SPDX-License-Identifier: Apache-2.0
// OptiTrack Motive CSV: one line of keys and values, then lines that give the type, name and
// quantity of each column, then rows:
//   Format Version,1.23,Take Name,...,Export Frame Rate,120,...,Length Units,Meters,...
//
//   ,Type,Marker,Marker,Marker
//   ,Name,A,A,A
//   ,ID,...
//   ,,Position,Position,Position
//   Frame,Time (Seconds),X,Y,Z
// Markers are points; the rigid bodies' origins are, if there are no markers.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "hosted/files/input_error.h"
#include "recordings/csv_columns.h"
#include "recordings/maker_tables.h"

namespace condyle::host {
namespace {

using Fields = std::vector<std::string_view>;

std::string_view at(const Fields& fields, std::size_t index) {
  return index < fields.size() ? fields[index] : std::string_view();
}

// What a column's type is worth: the lowest rank of the file is read.
int rank_of(std::string_view type) {
  if (type == "Marker") return 0;
  if (type.ends_with("Marker")) return 1;
  if (type == "Rigid Body" || type == "RigidBody") return 2;
  return 3;
}

constexpr int kLowestRank = 3;

}  // namespace

std::optional<TableFile> read_motive_csv(const MakerFile& file) {
  constexpr std::size_t kMostLines = 16;
  const auto& lines = file.start.lines;
  if (!lines[0].starts_with("Format Version,")) return std::nullopt;
  TableFile table;
  table.info.format = "OptiTrack Motive CSV";
  table.info.kind = SampleKind::one_point;
  table.info.stated.maker = "OptiTrack Motive";
  std::string_view unit;
  std::optional<double> export_Hz, capture_Hz;
  const Fields keys = file.fields(0, ',');
  for (std::size_t i = 0; i + 1 < keys.size(); i += 2) {
    if (keys[i] == "Export Frame Rate") export_Hz = file.rate_Hz(keys[i + 1], 0);
    if (keys[i] == "Capture Frame Rate") capture_Hz = file.rate_Hz(keys[i + 1], 0);
    if (keys[i] == "Length Units") unit = keys[i + 1];
    double frames = 0;
    if (keys[i] == "Total Exported Frames" &&
        parse_number(keys[i + 1], frames) == NumberStatus::ok && frames >= 0 && frames < 1e15) {
      table.info.stated.frames = static_cast<std::uint64_t>(frames);
    }
  }
  const std::optional<double> rate_Hz = export_Hz ? export_Hz : capture_Hz;
  Fields types, names, quantities, axes;
  std::size_t line = 1;
  for (; line < std::min(lines.size(), kMostLines) && axes.empty(); ++line) {
    const Fields fields = file.fields(line, ',');
    if (at(fields, 0) == "Frame") {
      axes = fields;
    } else if (at(fields, 1) == "Type") {
      types = fields;
    } else if (at(fields, 1) == "Name") {
      names = fields;
    } else if (fields.size() > 2) {
      quantities = fields;
    }
  }
  const auto lacks = [&](const char* what) {
    throw InputError(file.place(0), fmt::format("the header of the Motive file lacks {}", what),
                     "export it from Motive with its header and markers");
  };
  if (!rate_Hz) lacks("Export Frame Rate");
  if (axes.empty()) lacks("the line that begins with Frame");
  if (types.empty() || names.empty() || quantities.empty()) lacks("types, names or quantities");
  const double metres_each = file.metres_each(unit, 0);
  table.info.stated.unit = std::string(unit);

  int rank = kLowestRank;
  const auto is_place = [&](std::size_t i) {
    return at(quantities, i) == "Position" && axis_of(axes[i]).has_value();
  };
  for (std::size_t i = 2; i < axes.size(); ++i) {
    if (is_place(i)) rank = std::min(rank, rank_of(at(types, i)));
  }
  std::map<std::string, std::size_t, std::less<>> points;
  std::optional<std::size_t> time;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    TableColumn column;
    column.name = fmt::format("{} {}", at(names, i), axes[i]);
    if (axes[i].starts_with("Time")) time = i;
    if (i >= 2 && rank < kLowestRank && is_place(i) && rank_of(at(types, i)) == rank) {
      const std::string name(at(names, i));
      const auto [point, is_new] = points.emplace(name, points.size());
      if (is_new) table.table.names.push_back(name);
      column.role = TableColumn::Role::coordinate;
      column.coordinate = 3 * point->second + *axis_of(axes[i]);
      column.per_SI_unit = 1 / metres_each;
    }
    table.table.columns.push_back(std::move(column));
  }
  if (points.empty()) lacks("places of markers or rigid bodies");
  if (rank == 2) {
    table.info.notes.emplace_back("no markers: the points are the origins of the rigid bodies");
  }
  table.table.style.separator = ',';
  table.table.header_lines = line;
  table.table.has_ragged_rows = true;
  table.table.has_zeros_for_missing = true;
  use_rate(table, file, 0, time, *rate_Hz);
  return table;
}

}  // namespace condyle::host
