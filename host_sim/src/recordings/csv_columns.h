// SPDX-License-Identifier: Apache-2.0
// What the name of a column in a CSV file means: "Time (s)", "t_ms", "Marker1:X", "jaw_x_mm".
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace condyle::host {

/// The meaning of a column's name.
struct ColumnMeaning {
  enum class Quantity {
    unknown,
    not_read,  ///< such as a sub-frame
    time,
    frame,
    one_axis,
    point,
    drive,
  };
  Quantity quantity = Quantity::unknown;
  std::string point;          ///< name of the point
  std::size_t axis = 0;       ///< 0 to 2: x, y, z
  double each = 0;            ///< metres or seconds in one of its unit; 0: the unit is not stated
  std::string unit;           ///< as stated; may be empty
  bool has_bad_unit = false;  ///< its unit is not one of its quantity
  std::string other_unit;     ///< a unit below the name that contradicts it; empty: none does
};

/// What the names of exported estimates begin with: they are not measurements, and not read.
inline constexpr std::string_view kEstimatePrefix = "estimate_";

/// The meaning of the column `name`, whose unit may stand in a row below it. `drive_column`: the
/// name of the drive.
ColumnMeaning meaning_of(std::string_view name, std::string_view unit_below,
                         std::string_view drive_column);

/// True if `text` names a unit that meaning_of knows, or is empty.
bool is_unit_or_empty(std::string_view text);

/// 0 to 2 if `text` is x, y or z, in either case.
std::optional<std::size_t> axis_of(std::string_view text);

/// Metres in one of `unit`: mm, cm, m, um and their long names; 0: not a length.
double metres_in(std::string_view unit);

}  // namespace condyle::host
