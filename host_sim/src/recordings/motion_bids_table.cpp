// SPDX-License-Identifier: Apache-2.0
// Motion-BIDS: "STEM_motion.tsv" has rows without a header; "STEM_channels.tsv" beside it names the
// columns (name, component, type, tracked_point, units), and "STEM_motion.json" the rate
// (SamplingFrequency). Positions (POS) are points; a LATENCY channel is the time (s).
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "hosted/files/input_error.h"
#include "recordings/csv_columns.h"
#include "recordings/maker_tables.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

constexpr std::string_view kEnd = "_motion.tsv";

std::string beside(const std::string& path, std::string_view end) {
  const std::string other = path.substr(0, path.size() - kEnd.size()) + std::string(end);
  std::error_code missing;
  if (!std::filesystem::exists(other, missing)) {
    throw InputError(
        path, fmt::format("needs {} beside it", std::filesystem::path(other).filename().string()),
        "copy the recording with the files that describe it");
  }
  return other;
}

double sampling_frequency_Hz(const std::string& path) {
  ByteReader reader(path);
  const std::string_view text = reader.peek(ByteReader::kLongestLine);
  const nlohmann::json description =
      nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
  if (!description.is_object()) {
    throw InputError(path, "is not a JSON object", "correct the file");
  }
  const auto rate = description.find("SamplingFrequency");
  if (rate == description.end() || !rate->is_number() || !(rate->get<double>() >= 1e-3) ||
      !(rate->get<double>() <= 1e6)) {
    throw InputError(path, "has no usable SamplingFrequency", "give it as a number in Hz");
  }
  return rate->get<double>();
}

void read_channels(const std::string& path, const MakerFile& file, TableFile& table) {
  ByteReader reader(path);
  RowReader rows(reader);
  std::string_view row;
  std::vector<std::string_view> fields;
  if (rows.next(row)) split_fields(row, '\t', fields);
  const std::vector<std::string> heads(fields.begin(), fields.end());
  std::map<std::string, std::size_t, std::less<>> points;
  while (rows.next(row)) {
    split_fields(row, '\t', fields);
    const auto value_of = [&](std::string_view head) -> std::string_view {
      const auto found = std::find(heads.begin(), heads.end(), head);
      const auto index = static_cast<std::size_t>(found - heads.begin());
      return index < fields.size() && index < heads.size() ? fields[index] : std::string_view();
    };
    TableColumn column;
    column.name = std::string(value_of("name"));
    const std::string_view type = value_of("type");
    const auto axis = axis_of(value_of("component"));
    if (type == "LATENCY") column.role = TableColumn::Role::time;
    if (type == "POS" && axis) {
      const std::string name(value_of("tracked_point"));
      const auto [point, is_new] = points.emplace(name, points.size());
      if (is_new) table.table.names.push_back(name);
      const double each = metres_in(value_of("units"));
      if (each == 0 && !file.options.units_per_metre) {
        throw InputError(
            fmt::format("{}:{}", path, rows.line()),
            fmt::format("the unit {} of {} is not a length", quote(value_of("units")), column.name),
            "give --unit mm or --unit m, or correct it");
      }
      column.role = TableColumn::Role::coordinate;
      column.coordinate = 3 * point->second + *axis;
      column.per_SI_unit = each > 0 ? 1 / each : *file.options.units_per_metre;
      table.info.stated.unit = std::string(value_of("units"));
    }
    table.table.columns.push_back(std::move(column));
  }
  if (points.empty()) {
    throw InputError(path, "has no channels of type POS with the components x, y and z",
                     "give a recording of positions");
  }
}

}  // namespace

std::optional<TableFile> read_motion_bids(const MakerFile& file) {
  if (!file.path.ends_with(kEnd)) return std::nullopt;
  TableFile table;
  table.info.format = "Motion-BIDS";
  table.info.kind = SampleKind::one_point;
  read_channels(beside(file.path, "_channels.tsv"), file, table);
  table.table.style.separator = '\t';
  const bool has_times =
      std::any_of(table.table.columns.begin(), table.table.columns.end(),
                  [](const TableColumn& column) { return column.role == TableColumn::Role::time; });
  const double rate_Hz = sampling_frequency_Hz(beside(file.path, "_motion.json"));
  table.info.stated.rate_Hz = rate_Hz;
  if (!has_times) table.table.rate_Hz = rate_Hz;
  return table;
}

}  // namespace condyle::host
