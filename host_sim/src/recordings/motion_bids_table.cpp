// SPDX-License-Identifier: Apache-2.0
// Motion-BIDS: "STEM_motion.tsv" has rows without a header; "STEM_channels.tsv" beside it names the
// columns (name, component, type, tracked_point, units), and "STEM_motion.json" the rate
// (SamplingFrequency). Positions (POS) are points; a LATENCY channel is the time (s). One point
// with a quaternion (ORNT) is a pose. A channel "drive" in N is the drive. "STEM_events.tsv" names
// instants.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

std::string name_beside(const std::string& path, std::string_view end) {
  return path.substr(0, path.size() - kEnd.size()) + std::string(end);
}

std::string beside(const std::string& path, std::string_view end) {
  const std::string other = name_beside(path, end);
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

// Rows of a table of BIDS, whose first row names the columns.
class BidsRows {
 public:
  explicit BidsRows(const std::string& path) : path_(path), reader_(path), rows_(reader_) {
    if (next()) heads_.assign(fields_.begin(), fields_.end());
  }
  bool next() {
    std::string_view row;
    if (!rows_.next(row)) return false;
    split_fields(row, '\t', fields_);
    return true;
  }
  /// The field below `head`; empty if there is none.
  std::string_view at(std::string_view head) const {
    const auto found = std::find(heads_.begin(), heads_.end(), head);
    const auto index = static_cast<std::size_t>(found - heads_.begin());
    return index < fields_.size() && index < heads_.size() ? fields_[index] : std::string_view();
  }
  std::string place() const { return fmt::format("{}:{}", path_, rows_.line()); }

 private:
  const std::string& path_;
  ByteReader reader_;
  RowReader rows_;
  std::vector<std::string> heads_;
  std::vector<std::string_view> fields_;
};

void use_position(const BidsRows& row, const MakerFile& file, std::size_t coordinate,
                  TableColumn& column, TableFile& table) {
  const double each = metres_in(row.at("units"));
  if (each == 0 && !file.options.units_per_metre) {
    throw InputError(
        row.place(),
        fmt::format("the unit {} of {} is not a length", quote(row.at("units")), column.name),
        "give --unit mm or --unit m, or correct it");
  }
  column.role = TableColumn::Role::coordinate;
  column.coordinate = coordinate;
  column.per_SI_unit = file.options.units_per_metre ? *file.options.units_per_metre : 1 / each;
  table.info.stated.unit = std::string(row.at("units"));
}

void read_channels(const std::string& path, const MakerFile& file, TableFile& table) {
  constexpr std::string_view kQuaternion[] = {"quat_w", "quat_x", "quat_y", "quat_z"};
  BidsRows rows(path);
  std::map<std::string, std::size_t, std::less<>> points;
  std::size_t turns[4] = {}, turn_count = 0;  // columns of a quaternion
  std::string turned;
  while (rows.next()) {
    TableColumn column;
    column.name = std::string(rows.at("name"));
    const std::string_view type = rows.at("type"), component = rows.at("component");
    const std::string name(rows.at("tracked_point"));
    const auto axis = axis_of(component);
    if (type == "LATENCY") column.role = TableColumn::Role::time;
    if (type == "POS" && axis) {
      const auto [point, is_new] = points.emplace(name, points.size());
      if (is_new) table.table.names.push_back(name);
      use_position(rows, file, 3 * point->second + *axis, column, table);
    }
    if (type == "MISC" && column.name == "drive" && rows.at("units") == "N") {
      column.role = TableColumn::Role::drive;
      table.info.has_drive = true;
    }
    const auto part = std::find(std::begin(kQuaternion), std::end(kQuaternion), component);
    if (type == "ORNT" && part != std::end(kQuaternion) && (turn_count == 0 || name == turned)) {
      turned = name;
      turns[part - std::begin(kQuaternion)] = table.table.columns.size();
      ++turn_count;
    }
    table.table.columns.push_back(std::move(column));
  }
  if (points.empty()) {
    throw InputError(path, "has no channels of type POS with the components x, y and z",
                     "give a recording of positions");
  }
  if (turn_count != 4 || points.size() != 1 || table.table.names[0] != turned) return;
  table.info.kind = SampleKind::pose;
  table.table.names.clear();
  for (std::size_t i = 0; i < 4; ++i) {
    table.table.columns[turns[i]].role = TableColumn::Role::coordinate;
    table.table.columns[turns[i]].coordinate = 3 + i;
  }
}

void read_events(const std::string& path, RecordingInfo& info) {
  std::error_code missing;
  if (!std::filesystem::exists(path, missing)) return;
  BidsRows rows(path);
  while (rows.next()) {
    double onset_s = 0;
    const std::string_view text = rows.at("onset");
    const NumberStatus status = parse_field(text, {'\t', false}, onset_s);
    if (status == NumberStatus::empty) continue;  // an event without a known time
    if (status != NumberStatus::ok || std::abs(onset_s) > kFurthestTime_s) {
      throw InputError(rows.place() + ": column onset",
                       fmt::format("{} is not a time in seconds", quote(text)),
                       "correct the file, or write n/a");
    }
    info.stated.events.push_back({onset_s, std::string(rows.at("trial_type"))});
  }
}

}  // namespace

std::optional<TableFile> read_motion_bids(const MakerFile& file) {
  if (!file.path.ends_with(kEnd)) return std::nullopt;
  TableFile table;
  table.info.format = "Motion-BIDS";
  table.info.kind = SampleKind::one_point;
  read_channels(beside(file.path, "_channels.tsv"), file, table);
  read_events(name_beside(file.path, "_events.tsv"), table.info);
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
