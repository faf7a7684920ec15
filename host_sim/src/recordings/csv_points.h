// SPDX-License-Identifier: Apache-2.0
// The points that the columns of a CSV file name: "apex_x_mm" is x of the point "apex".
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/estimator/sample.h"
#include "recordings/csv_columns.h"
#include "recordings/text_table.h"

namespace condyle::host {

/// A column NAME_x_mm, or _y_, _z_, _m.
struct PointColumn {
  std::string_view point;
  std::size_t axis = 0;
  std::string_view unit;  ///< "m" or "mm"
};

/// None for other names. NAME begins with a letter and continues with letters, digits, '_' and '-'.
std::optional<PointColumn> point_column(std::string_view name);

/// True if `ignored`, a value of --ignore-column, means the column `name`: its name, or "NAME_*"
/// for all coordinates of the point NAME.
bool ignores_column(std::string_view ignored, std::string_view name);

/// The points of a file. "p1", "p2" and "p3" are points 1 to 3; other names take the numbers that
/// are left, in the order of their first columns.
class CsvPoints {
 public:
  void add(const PointColumn& column);
  bool empty() const { return points_.empty(); }
  /// one_point or three_points, which also stands for more than three if `takes_any_number`. Throws
  /// InputError at `place` for any other number of points, and for points that lack a coordinate.
  SampleKind kind(const std::string& place, bool takes_any_number) const;
  /// The names in the order of the points' numbers. Valid after all are added.
  std::vector<std::string> names() const;
  /// Index of the column among the coordinates of a sample. Valid after all are added.
  std::size_t coordinate(const PointColumn& column) const;
  /// Which name is which point: "point 1 is apex"; empty for p1 to p3.
  std::string note() const;

 private:
  struct Point {
    std::string name;
    std::array<bool, 3> has_axis{};
  };
  std::vector<const Point*> by_number() const;

  std::vector<Point> points_;  // in the order of their first columns
};

/// The column `name` of a table, by its meaning. `has_rate`: frames are times.
TableColumn table_column(const ColumnMeaning& meaning, const std::string& name,
                         const CsvPoints& points, bool has_rate);

}  // namespace condyle::host
