// SPDX-License-Identifier: Apache-2.0
#include "recordings/number_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hosted/files/input_error.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

using Role = TableColumn::Role;

class NumberTable final : public NamedPointsRecording {
 public:
  NumberTable(std::unique_ptr<NumberRows> rows, TableFile file, const RecordingOptions& options)
      : rows_(std::move(rows)),
        rule_(options.faults),
        filled_(options.missing),
        layout_(std::move(file.table)),
        info_(std::move(file.info)) {
    points_m_.resize(3, static_cast<Eigen::Index>(layout_.names.size()));
    has_frames_ = std::any_of(layout_.columns.begin(), layout_.columns.end(),
                              [](const TableColumn& one) { return one.role == Role::frame; });
    if (layout_.rate_Hz) {
      info_.stated.rate_Hz = layout_.rate_Hz;
      if (*layout_.rate_Hz <= 1e9) info_.nominal_step_ns = nanoseconds(1 / *layout_.rate_Hz);
    }
  }

  bool next(Sample& sample) override {
    if (!rows_->next(row_)) {
      if (!has_ended_) filled_.add_notes(info_.notes);
      has_ended_ = true;
      return false;
    }
    sample = Sample{};
    sample.kind = info_.kind;
    sample.sequence = sequence_++;
    sample.drive_valid = info_.has_drive;
    points_m_.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (layout_.rate_Hz && !has_frames_) set_time(static_cast<double>(sample.sequence), sample);
    for (std::size_t i = 0; i < layout_.columns.size(); ++i) {
      read_column(layout_.columns[i], row_[i], sample);
    }
    const double units = units_per_metre(layout_);
    const bool is_filled = !layout_.names.empty()
                               ? filled_.drop(points_m_, units, [this] { return place(); })
                               : sample.position_valid && info_.kind == SampleKind::one_axis &&
                                     filled_.is_missing(sample.coordinates[0], units);
    if (is_filled) sample.position_valid = false;
    if (info_.kind == SampleKind::one_axis || layout_.names.size() <= 3) {
      if (is_out_of_range(sample.kind, sample.coordinates)) sample.position_valid = false;
    }
    return true;
  }

  const std::vector<std::string>& names() const override { return layout_.names; }
  const Eigen::Matrix3Xd& points_m() const override { return points_m_; }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return rows_->place(); }
  double progress() const override { return rows_->progress(); }

 private:
  void read_column(const TableColumn& column, double value, Sample& sample) {
    switch (column.role) {
      case Role::ignored:
      case Role::first_time:
        break;
      case Role::time:
        sample.time_valid = is_there(column, value, true);
        if (sample.time_valid) set_seconds(value / column.per_SI_unit, sample);
        break;
      case Role::frame:
        sample.time_valid = is_there(column, value, true);
        if (!sample.time_valid) break;
        if (value != std::floor(value) || std::abs(value) > 1e15) {
          throw InputError(fmt::format("{}: column {}", place(), column.name),
                           fmt::format("{:g} is not a frame number", value),
                           "frames are whole numbers");
        }
        if (!first_frame_) first_frame_ = value;
        set_time(value - *first_frame_, sample);
        break;
      case Role::coordinate:
        read_coordinate(column, value, sample);
        break;
      case Role::drive:
        sample.drive_valid = is_there(column, value, false);
        if (sample.drive_valid) sample.drive_N = value / column.per_SI_unit;
        break;
    }
  }

  // A missing time is a fault. A missing position or force is counted.
  bool is_there(const TableColumn& column, double value, bool is_time) const {
    if (std::isfinite(value)) return true;
    if (is_time || std::isinf(value)) {
      const NumberStatus status =
          std::isinf(value) ? NumberStatus::not_finite : NumberStatus::empty;
      rule_.accept(status, place(), column.name, std::signbit(value) ? "-Inf" : "Inf");
    }
    return false;
  }

  void read_coordinate(const TableColumn& column, double value, Sample& sample) {
    const double value_m = value / column.per_SI_unit;
    if (!is_there(column, value, false) || is_missing_coordinate(value, 1 / column.per_SI_unit)) {
      sample.position_valid = false;
      return;
    }
    if (column.coordinate < std::size(sample.coordinates)) {
      sample.coordinates[column.coordinate] = value_m;
    }
    if (layout_.names.empty() || std::abs(value_m) > kFarthestPosition_m) return;
    points_m_(static_cast<Eigen::Index>(column.coordinate % 3),
              static_cast<Eigen::Index>(column.coordinate / 3)) = value_m;
  }

  void set_time(double frame, Sample& sample) { set_seconds(frame / *layout_.rate_Hz, sample); }

  void set_seconds(double time_s, Sample& sample) {
    if (!(std::abs(time_s) <= kFurthestTime_s)) {
      throw InputError(place(), fmt::format("its time of {:.3g} s is out of range", time_s),
                       "check the times and the rate");
    }
    sample.time_ns = nanoseconds(time_s);
  }

  std::unique_ptr<NumberRows> rows_;
  FaultRule rule_;
  FilledNumbers filled_;
  TableLayout layout_;
  RecordingInfo info_;
  bool has_frames_ = false, has_ended_ = false;
  std::vector<double> row_;
  Eigen::Matrix3Xd points_m_;  // of the sample last returned, one a column
  std::uint64_t sequence_ = 0;
  std::optional<double> first_frame_;
};

}  // namespace

std::unique_ptr<NamedPointsRecording> open_number_table(std::unique_ptr<NumberRows> rows,
                                                        TableFile file,
                                                        const RecordingOptions& options) {
  return std::make_unique<NumberTable>(std::move(rows), std::move(file), options);
}

}  // namespace condyle::host
