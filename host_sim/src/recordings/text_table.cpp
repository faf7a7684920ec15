// SPDX-License-Identifier: Apache-2.0
#include "recordings/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hosted/files/input_error.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

using Role = TableColumn::Role;

// Characters of a number from its decimal sign on; nothing for a missing value.
std::optional<std::size_t> decimals_of(std::string_view text) {
  if (is_missing_word(text)) return std::nullopt;
  const std::size_t sign = text.find_last_of(".,");
  return sign == std::string_view::npos ? 0 : text.size() - sign;
}

// Whether a file ends within its last number: the last line has no end, and the number has fewer
// decimals than that of every row before.
class CutEnd {
 public:
  bool is_at(std::string_view last_field, bool is_line_ended) {
    const std::optional<std::size_t> decimals = decimals_of(last_field);
    if (!decimals) return false;
    const bool is_cut = !is_line_ended && rows_ > 1 && !varies_ && *decimals < decimals_;
    varies_ = varies_ || (rows_ > 0 && *decimals != decimals_);
    decimals_ = *decimals;
    ++rows_;
    return is_cut;
  }

 private:
  std::size_t rows_ = 0, decimals_ = 0;
  bool varies_ = false;
};

// Frames that a file's numbers pass over, by the times beside them.
class TimeJumps {
 public:
  // Frames that are lacking up to the frame `frame`, whose time the file states as `text`.
  double until(double frame, std::string_view text, const TableLayout& layout) {
    double time_s = 0;
    if (parse_field(text, layout.style, time_s) != NumberStatus::ok) return lacking_;
    decimals_ = std::max(decimals_, decimals_of(text).value_or(0));
    if (last_frame_) {
      // Both times are rounded: by one unit of the last decimal at most.
      const double rounding_s = decimals_ == 0 ? 1 : std::pow(0.1, decimals_ - 1);
      const double steps = (time_s - last_s_) * *layout.rate_Hz - (frame - *last_frame_);
      if (std::abs(steps) > 0.5 + rounding_s * *layout.rate_Hz) {
        lacking_ += std::round(steps);
        ++count_;
      }
    }
    last_frame_ = frame;
    last_s_ = time_s;
    return lacking_;
  }
  std::uint64_t count() const { return count_; }

 private:
  double lacking_ = 0, last_s_ = 0;
  std::optional<double> last_frame_;
  std::size_t decimals_ = 0;  // with their sign
  std::uint64_t count_ = 0;
};

class TableRecording final : public NamedPointsRecording {
 public:
  TableRecording(std::unique_ptr<ByteReader> reader, TableFile file,
                 const RecordingOptions& options)
      : reader_(std::move(reader)),
        rows_(*reader_, file.table.style.separator, file.table.has_comments),
        rule_(options.faults),
        filled_(options.missing),
        layout_(std::move(file.table)),
        info_(std::move(file.info)) {
    std::string_view line;
    for (std::size_t i = 0; i < layout_.header_lines; ++i) reader_->next_line(line);
    points_m_.resize(3, static_cast<Eigen::Index>(layout_.names.size()));
    if (layout_.rate_Hz) {
      info_.stated.rate_Hz = layout_.rate_Hz;
      if (*layout_.rate_Hz <= 1e9) info_.nominal_step_ns = nanoseconds(1 / *layout_.rate_Hz);
    }
  }

  bool next(Sample& sample) override {
    std::string_view row;
    if (has_ended_) return false;
    std::size_t blank = 0;
    do {
      if (!rows_.next(row) || (row.empty() && layout_.ends_at_blank_row)) {
        end();
        return false;
      }
    } while (row.empty() && blank++ < layout_.blank_lines_between);
    sample = Sample{};
    sample.kind = info_.kind;
    sample.sequence = sequence_++;
    sample.drive_valid = info_.has_drive;
    points_m_.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (row.empty()) {
      rule_.accept(NumberStatus::empty, place(), layout_.columns[0].name, "");
      sample.position_valid = sample.drive_valid = false;
      sample.time_valid = layout_.rate_Hz.has_value() && !has_frames();
      if (sample.time_valid) set_time(static_cast<double>(sample.sequence), sample);
      return true;
    }
    parse_row(row, sample);
    return true;
  }

  const std::vector<std::string>& names() const override { return layout_.names; }
  const Eigen::Matrix3Xd& points_m() const override { return points_m_; }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return fmt::format("{}:{}", reader_->path(), rows_.line()); }
  double progress() const override { return reader_->progress(); }

 private:
  void end() {
    has_ended_ = true;
    filled_.add_notes(info_.notes);
    if (jumps_.count() > 0) {
      info_.notes.push_back(fmt::format(
          "its times jump {} time{}, its frame numbers do not: the times are used there",
          jumps_.count(), jumps_.count() == 1 ? "" : "s"));
    }
    if (!info_.stated.frames || *info_.stated.frames == sequence_) return;
    info_.notes.push_back(
        fmt::format("its header states {} frames; it holds {}", *info_.stated.frames, sequence_));
  }

  bool has_frames() const {
    return std::any_of(layout_.columns.begin(), layout_.columns.end(),
                       [](const TableColumn& column) { return column.role == Role::frame; });
  }

  void check_width() {
    const std::size_t columns = layout_.columns.size();
    if (fields_.size() == columns) return;
    // Some programs end each row, or only the header, with separators.
    if (fields_.size() > columns &&
        std::all_of(fields_.begin() + static_cast<std::ptrdiff_t>(columns), fields_.end(),
                    [](std::string_view field) { return field.empty(); })) {
      return;
    }
    const bool is_longer = fields_.size() > columns;
    if (layout_.has_ragged_rows) {
      if (is_longer) refuse_split_decimals();
      if (!is_longer) check_end();
      fields_.resize(columns);
      return;
    }
    throw InputError(
        fmt::format("{}: column {}", place(),
                    layout_.columns[std::min(fields_.size(), columns - 1)].name),
        fmt::format("the row has {} columns, the header names {}", fields_.size(), columns),
        is_longer && layout_.style.separator == ','
            ? "write decimals with a decimal point, not a comma, and no separators of thousands"
            : fmt::format("complete the row{}", layout_.style.separator == ','
                                                    ? "; numbers take a decimal point, not a comma"
                                                    : ""));
  }

  // A row without a point, of more columns than the header: its commas separate decimals too.
  void refuse_split_decimals() const {
    const bool has_point = std::any_of(fields_.begin(), fields_.end(), [](std::string_view field) {
      return field.find('.') != std::string_view::npos;
    });
    if (layout_.style.separator != ',' || has_point) return;
    throw InputError(place(),
                     fmt::format("the row has {} columns, the header names {}", fields_.size(),
                                 layout_.columns.size()),
                     "export it with decimal points, or with tabs between the columns");
  }

  // A row may lack whole points at its end, where separators show which.
  void check_end() const {
    const std::size_t size = fields_.size();
    const TableColumn &last = layout_.columns[size - 1], &lacking = layout_.columns[size];
    const bool is_inside_point =
        last.role == Role::coordinate && lacking.role == Role::coordinate &&
        last.coordinate / 3 == lacking.coordinate / 3 && !fields_.back().empty();
    if (layout_.style.separator != ' ' && !is_inside_point) return;
    throw InputError(
        place(),
        fmt::format("the row has {} columns, the header names {}: which are missing is "
                    "not known",
                    size, layout_.columns.size()),
        "export it with tabs between the columns, or with NaN for missing places");
  }

  void parse_row(std::string_view line, Sample& sample) {
    split_fields(line, layout_.style.separator, fields_);
    check_width();
    if (fields_.size() == layout_.columns.size() &&
        cut_end_.is_at(fields_.back(), reader_->is_line_ended())) {
      fields_.back() = {};
      info_.notes.push_back(fmt::format(
          "{}: the file ends within its last number, which is not read; copy the file again",
          place()));
    }
    bool has_frame = false;
    std::string_view stated_time;
    for (std::size_t i = 0; i < layout_.columns.size(); ++i) {
      const TableColumn& column = layout_.columns[i];
      double value = 0;
      switch (column.role) {
        case Role::ignored:
          break;
        case Role::time:
          read_time(column, fields_[i], sample);
          break;
        case Role::first_time:
          if (sample.sequence == 0) read_time(column, fields_[i], sample);
          if (sample.sequence == 0 && sample.time_valid) start_ns_ = sample.time_ns;
          stated_time = fields_[i];
          break;
        case Role::frame:
          has_frame = read_frame(column, fields_[i], value);
          if (!has_frame) sample.time_valid = false;
          if (has_frame && !first_frame_) first_frame_ = value;
          if (has_frame) frame_ = value - *first_frame_;
          break;
        case Role::coordinate:
          read_coordinate(column, fields_[i], sample);
          break;
        case Role::drive:
          if (!read_value(column, fields_[i], sample.drive_N)) sample.drive_valid = false;
          break;
      }
    }
    if (layout_.rate_Hz && (has_frame || !has_frames())) {
      const double frame = has_frame ? frame_ : static_cast<double>(sample.sequence);
      sample.time_valid = true;
      set_time(frame + jumps_.until(frame, stated_time, layout_), sample);
    }
    if (!layout_.names.empty()) {
      drop_unseen(sample);
    } else if (sample.position_valid && info_.kind == SampleKind::one_axis &&
               filled_.is_missing(sample.coordinates[0], units_per_metre(layout_))) {
      sample.position_valid = false;
    }
    if (info_.kind == SampleKind::one_axis || layout_.names.size() <= 3) {
      if (is_out_of_range(sample.kind, sample.coordinates)) sample.position_valid = false;
    }
  }

  // False, for a missing value; an InputError for text that is no number.
  bool read_value(const TableColumn& column, std::string_view text, double& value) {
    const NumberStatus status = parse_field(text, layout_.style, value);
    if (status == NumberStatus::ok) return true;
    if (status != NumberStatus::empty) rule_.accept(status, place(), column.name, text);
    return false;
  }

  void read_coordinate(const TableColumn& column, std::string_view text, Sample& sample) {
    double value = 0;
    const bool is_there =
        read_value(column, text, value) && !is_missing_coordinate(value, 1 / column.per_SI_unit);
    const double value_m = value / column.per_SI_unit;
    if (!is_there) sample.position_valid = false;
    if (column.coordinate < std::size(sample.coordinates) && is_there) {
      sample.coordinates[column.coordinate] = value_m;
    }
    if (layout_.names.empty() || !is_there || std::abs(value_m) > kFarthestPosition_m) return;
    points_m_(static_cast<Eigen::Index>(column.coordinate % 3),
              static_cast<Eigen::Index>(column.coordinate / 3)) = value_m;
  }

  void read_time(const TableColumn& column, std::string_view text, Sample& sample) {
    double value = 0;
    NumberStatus status = parse_field(text, layout_.style, value);
    if (status == NumberStatus::ok) {
      if (column.per_SI_unit == 1 && !layout_.style.has_decimal_comma) {
        status = parse_time_s(text, sample.time_ns);
      } else if (std::abs(value / column.per_SI_unit) <= kFurthestTime_s) {
        sample.time_ns = nanoseconds(value / column.per_SI_unit);
      } else {
        status = NumberStatus::overflow;
      }
    }
    sample.time_valid =
        status == NumberStatus::ok || rule_.accept(status, place(), column.name, text);
  }

  bool read_frame(const TableColumn& column, std::string_view text, double& value) {
    const NumberStatus status = parse_field(text, layout_.style, value);
    if (status != NumberStatus::ok) return rule_.accept(status, place(), column.name, text);
    constexpr double kMost = 1e15;
    if (std::abs(value) > kMost || value != std::floor(value)) {
      throw InputError(fmt::format("{}: column {}", place(), column.name),
                       fmt::format("{} is not a frame number", quote(text)),
                       "frames are whole numbers");
    }
    return true;
  }

  void set_time(double frame, Sample& sample) {
    const double since_start_s = frame / *layout_.rate_Hz;
    if (!(std::abs(seconds(start_ns_) + since_start_s) <= kFurthestTime_s)) {
      throw InputError(place(), fmt::format("its frame is {:.3g} s after the first", since_start_s),
                       "check the frame numbers and the rate");
    }
    sample.time_ns = start_ns_ + nanoseconds(since_start_s);
  }

  void drop_unseen(Sample& sample) {
    for (Eigen::Index point = 0; layout_.has_zeros_for_missing && point < points_m_.cols();
         ++point) {
      if (!points_m_.col(point).isZero(0)) continue;
      points_m_.col(point).setConstant(std::numeric_limits<double>::quiet_NaN());
      sample.position_valid = false;
    }
    if (filled_.drop(points_m_, units_per_metre(layout_), [this] { return place(); })) {
      sample.position_valid = false;
    }
  }

  std::unique_ptr<ByteReader> reader_;
  RowReader rows_;
  FaultRule rule_;
  FilledNumbers filled_;
  TableLayout layout_;
  RecordingInfo info_;
  std::vector<std::string_view> fields_;  // of the row being read
  Eigen::Matrix3Xd points_m_;             // of the sample last returned, one a column
  std::uint64_t sequence_ = 0;
  bool has_ended_ = false;
  CutEnd cut_end_;
  TimeJumps jumps_;
  TimeNs start_ns_ = 0;
  std::optional<double> first_frame_;
  double frame_ = 0;  // since the first
};

}  // namespace

std::unique_ptr<NamedPointsRecording> open_table(std::unique_ptr<ByteReader> reader, TableFile file,
                                                 const RecordingOptions& options) {
  return std::make_unique<TableRecording>(std::move(reader), std::move(file), options);
}

TableStart start_of(ByteReader& reader) {
  TableStart start;
  const std::string_view bytes = reader.peek(ByteReader::kLongestLine);
  start.is_whole = bytes.size() < ByteReader::kLongestLine;
  start.lines = lines_of(bytes, start.is_whole);
  return start;
}

double units_per_metre(const TableLayout& layout) {
  const auto first = std::find_if(
      layout.columns.begin(), layout.columns.end(),
      [](const TableColumn& column) { return column.role == TableColumn::Role::coordinate; });
  return first == layout.columns.end() ? 1 : first->per_SI_unit;
}

void add_point_columns(TableLayout& layout, const std::string& name, double metres_each) {
  const std::size_t point = layout.names.size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    layout.columns.push_back({TableColumn::Role::coordinate, 3 * point + axis, 1 / metres_each,
                              fmt::format("{} {}", name, "xyz"[axis])});
  }
  layout.names.push_back(name);
}

}  // namespace condyle::host
