// SPDX-License-Identifier: Apache-2.0
// All problems of a CSV file's header in one message, and the names that --columns gives.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/csv_columns.h"
#include "recordings/csv_units.h"
#include "recordings/recording.h"

namespace condyle::host {

inline constexpr std::string_view kColumns =
    "columns are time_s, position_m or position_mm, NAME_x_mm, NAME_y_mm, NAME_z_mm (or _m) of one "
    "point or three, drive_N";

/// Collects problems, then throws one InputError with all of them.
class HeaderProblems {
 public:
  explicit HeaderProblems(std::string place) : place_(std::move(place)) {}

  void add(const std::string& column, const std::string& problem, const std::string& mend);
  /// Of the header as a whole.
  void add_whole(const std::string& problem, const std::string& mend);
  void add_unknown(const std::string& column, const RecordingOptions& options);
  /// The same quantity as another one of `columns`.
  void add_repeated(const std::string& column, const std::vector<std::string>& columns,
                    const RecordingOptions& options);
  void throw_if_any() const;

 private:
  struct Problem {
    std::string column, text, mend;
  };
  std::string place_;
  std::vector<Problem> problems_;
};

/// Refuses the column `name` of times whose unit is not known, because of `reason`.
[[noreturn]] void refuse_time(const std::string& place, const std::string& name,
                              const std::vector<double>& values, const std::string& reason);

/// Refuses the column `name` of times whose stated unit is in `doubt`.
[[noreturn]] void refuse_stated_time(const std::string& place, const std::string& name,
                                     const TimesDoubt& doubt, const std::string& stated_unit);

/// The names that --columns gives to columns: "time_s=T".
class MappedColumns {
 public:
  bool empty() const { return columns_.empty(); }
  /// The name given to the column `index`.
  std::optional<std::string> name_of(std::size_t index) const;
  /// True if another column was named as `quantity`, or as a position for a position.
  bool replaces(ColumnMeaning::Quantity quantity) const;

 private:
  friend MappedColumns mapped_columns(const std::vector<std::string>& given,
                                      const std::vector<std::string>& names);
  struct Column {
    std::size_t index = 0;
    std::string name;
    ColumnMeaning::Quantity quantity;
  };
  std::vector<Column> columns_;
};

/// Throws InputError for what is not NEW=OLD with a known NEW and one of `names` for OLD.
MappedColumns mapped_columns(const std::vector<std::string>& given,
                             const std::vector<std::string>& names);

}  // namespace condyle::host
