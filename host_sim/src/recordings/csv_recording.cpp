// SPDX-License-Identifier: Apache-2.0
// CSV recordings. Columns, in any order:
//   time_s                              always
//   position_m | position_mm            one axis, or
//   NAME_x_mm, NAME_y_mm, NAME_z_mm     one point or three, such as p1, p2, p3 (or _m); any number
//                                       of points for readers that take points by name
//   drive_N                             measured total drive, optional
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "hosted/files/input_error.h"
#include "recordings/csv_points.h"
#include "recordings/named_points.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

constexpr std::string_view kColumns =
    "columns are time_s, position_m or position_mm, NAME_x_mm, NAME_y_mm, NAME_z_mm (or _m) of one "
    "point or three, drive_N";

constexpr std::size_t kLongestName = 100;

// The meaning of a column.
struct Column {
  enum class Role { ignored, time, coordinate, drive };
  Role role = Role::ignored;
  std::size_t coordinate = 0;
  double units_per_metre = 1;
  std::string name;
};

class CsvRecording final : public NamedPointsRecording {
 public:
  CsvRecording(std::unique_ptr<ByteReader> reader, const RecordingOptions& options,
               bool takes_any_number)
      : reader_(std::move(reader)),
        rows_(*reader_),
        rule_(options.faults),
        reads_drive_alone_(options.reads_drive_alone),
        may_lack_ignored_(options.may_lack_ignored),
        takes_any_number_(takes_any_number),
        drive_column_(options.drive_column) {
    read_header(options.ignored_columns);
  }

  bool next(Sample& sample) override {
    std::string_view row;
    if (!rows_.next(row)) return false;
    sample = Sample{};
    sample.kind = info_.kind;
    sample.sequence = sequence_++;
    points_m_.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (row.empty()) {
      rule_.accept(NumberStatus::empty, place(), columns_[0].name, "");
      sample.time_valid = sample.position_valid = false;
    } else {
      parse_row(row, sample);
    }
    return true;
  }

  const std::vector<std::string>& names() const override { return names_; }
  const Eigen::Matrix3Xd& points_m() const override { return points_m_; }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return fmt::format("{}:{}", reader_->path(), rows_.line()); }
  double progress() const override { return reader_->progress(); }

 private:
  void read_header(const std::vector<std::string>& ignored) {
    std::string_view line;
    if (!rows_.next(line)) line = {};
    if (line.find(',') == std::string_view::npos && line.find_first_of(";\t") != line.npos) {
      throw InputError(place(), "columns are not separated by commas",
                       "separate columns by commas and write decimals with points");
    }
    split_row(line, fields_);
    double first_value = 0;
    if (parse_number(fields_[0], first_value) != NumberStatus::not_a_number) {
      throw InputError(place(), "the first line does not name the columns",
                       fmt::format("add a first line such as time_s,position_m; {}", kColumns));
    }
    for (const std::string_view name : fields_) add_column(name, ignored);
    for (const std::string& name : ignored) {
      if (may_lack_ignored_) break;
      if (std::none_of(fields_.begin(), fields_.end(),
                       [&](std::string_view field) { return ignores_column(name, field); })) {
        throw InputError(place(), fmt::format("no column {} to ignore", quote(name)),
                         "check the name given to --ignore-column");
      }
    }
    check_layout();
    info_.format = "CSV";
  }

  void add_column(std::string_view name, const std::vector<std::string>& ignored) {
    if (name.size() > kLongestName) {
      throw InputError(place(), fmt::format("the column name {} is too long", quote(name)),
                       "check that the first line names the columns");
    }
    Column column;
    column.name = std::string(name);
    std::string_view unit;
    const bool is_ignored =
        std::any_of(ignored.begin(), ignored.end(),
                    [&](const std::string& other) { return ignores_column(other, name); });
    if (is_ignored) {
      column.role = Column::Role::ignored;
    } else if (name == "time_s") {
      column.role = Column::Role::time;
    } else if (name == drive_column_) {
      column.role = Column::Role::drive;
      info_.has_drive = true;
    } else if (name == "position_m" || name == "position_mm") {
      column.role = Column::Role::coordinate;
      unit = name.substr(9);
      ++axis_columns_;
    } else if (const auto of_point = point_column(name)) {
      column.role = Column::Role::coordinate;
      unit = of_point->unit;
      points_.add(*of_point);
    } else {
      throw InputError(
          fmt::format("{}: column {}", place(), quote(name)), "the column is not known",
          reads_drive_alone_ ? fmt::format("take it out of the file; {} is read", drive_column_)
                             : fmt::format("rename it, after converting its unit, or leave it out "
                                           "with --ignore-column '{}'; {}",
                                           name, kColumns));
    }
    if (unit == "mm") column.units_per_metre = 1000;
    const auto quantity = [](std::string_view full) { return full.substr(0, full.rfind('_')); };
    const bool repeated = std::any_of(columns_.begin(), columns_.end(), [&](const Column& other) {
      return !is_ignored && other.role == column.role && quantity(other.name) == quantity(name);
    });
    if (repeated) {
      throw InputError(fmt::format("{}: column {}", place(), name),
                       "another column contains the same quantity",
                       reads_drive_alone_ ? "take one of them out of the file"
                                          : "leave one of them out with --ignore-column");
    }
    columns_.push_back(column);
  }

  void check_layout() {
    const auto has = [&](Column::Role role) {
      return std::any_of(columns_.begin(), columns_.end(),
                         [role](const Column& column) { return column.role == role; });
    };
    if (!has(Column::Role::time)) {
      throw InputError(place(), "no column time_s", "name the column with the time in seconds");
    }
    if (reads_drive_alone_) {
      if (info_.has_drive) return;
      throw InputError(place(), fmt::format("no column {}", drive_column_),
                       "give the column with the measured drive that name");
    }
    if (axis_columns_ == 1 && points_.empty()) {
      info_.kind = SampleKind::one_axis;
      return;
    }
    if (axis_columns_ > 0 || points_.empty()) {
      throw InputError(place(),
                       points_.empty() ? "no position column"
                                       : "the position columns are not a complete set: position "
                                         "is one axis, the others are points",
                       "give position_m, or x, y, z of one point or of three");
    }
    info_.kind = points_.kind(place(), takes_any_number_);
    names_ = points_.names();
    points_m_.resize(3, static_cast<Eigen::Index>(names_.size()));
    for (Column& column : columns_) {
      const auto of_point = point_column(column.name);
      if (column.role == Column::Role::coordinate)
        column.coordinate = points_.coordinate(*of_point);
    }
    if (names_.size() > 3) return;  // whoever takes them by name says which
    if (std::string note = points_.note(); !note.empty()) info_.notes.push_back(std::move(note));
  }

  void parse_row(std::string_view line, Sample& sample) {
    split_row(line, fields_);
    if (fields_.size() != columns_.size()) {
      throw InputError(fmt::format("{}: column {}", place(),
                                   columns_[std::min(fields_.size(), columns_.size() - 1)].name),
                       fmt::format("the row has {} columns, the header names {}", fields_.size(),
                                   columns_.size()),
                       fields_.size() > columns_.size()
                           ? "write decimals with a decimal point, not a comma"
                           : "complete the row; numbers take a decimal point, not a comma");
    }
    sample.drive_valid = info_.has_drive;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Column& column = columns_[i];
      double value = 0;
      NumberStatus status = NumberStatus::ok;
      switch (column.role) {
        case Column::Role::ignored:
          continue;
        case Column::Role::time:
          status = parse_time_s(fields_[i], sample.time_ns);
          break;
        case Column::Role::coordinate: {
          status = parse_number(fields_[i], value);
          take_coordinate(column.coordinate, value / column.units_per_metre,
                          status == NumberStatus::ok, sample);
          break;
        }
        case Column::Role::drive:
          status = parse_number(fields_[i], sample.drive_N);
          break;
      }
      if (status == NumberStatus::ok) continue;
      rule_.accept(status, place(), column.name, fields_[i]);
      switch (column.role) {
        case Column::Role::time:
          sample.time_valid = false;
          break;
        case Column::Role::drive:
          sample.drive_valid = false;
          break;
        default:
          sample.position_valid = false;
          break;
      }
    }
    if (is_out_of_range(sample.kind, sample.coordinates)) sample.position_valid = false;
  }

  void take_coordinate(std::size_t coordinate, double value_m, bool is_number, Sample& sample) {
    if (coordinate < std::size(sample.coordinates)) sample.coordinates[coordinate] = value_m;
    if (names_.empty() || !is_number || std::abs(value_m) > kFarthestPosition_m) return;
    points_m_(static_cast<Eigen::Index>(coordinate % 3),
              static_cast<Eigen::Index>(coordinate / 3)) = value_m;
  }

  std::unique_ptr<ByteReader> reader_;
  RowReader rows_;
  FaultRule rule_;
  bool reads_drive_alone_, may_lack_ignored_, takes_any_number_;
  std::string drive_column_;
  RecordingInfo info_;
  std::vector<Column> columns_;
  std::vector<std::string_view> fields_;  // of the row being read
  CsvPoints points_;
  std::vector<std::string> names_;
  Eigen::Matrix3Xd points_m_;  // of the sample last returned, one a column
  std::ptrdiff_t axis_columns_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace

std::unique_ptr<Recording> open_csv(std::unique_ptr<ByteReader> reader,
                                    const RecordingOptions& options) {
  return std::make_unique<CsvRecording>(std::move(reader), options, false);
}

std::unique_ptr<NamedPointsRecording> open_csv_points(std::unique_ptr<ByteReader> reader,
                                                      const RecordingOptions& options) {
  return std::make_unique<CsvRecording>(std::move(reader), options, true);
}

}  // namespace condyle::host
