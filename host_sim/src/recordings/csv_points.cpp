// SPDX-License-Identifier: Apache-2.0
#include "recordings/csv_points.h"

#include <fmt/format.h>

#include <algorithm>

#include "hosted/files/input_error.h"
#include "recordings/point_list.h"

namespace condyle::host {
namespace {

constexpr std::size_t kMostPoints = 3;

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_point_name(std::string_view name) {
  return !name.empty() && is_letter(name[0]) && std::all_of(name.begin(), name.end(), [](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

// Index of "p1", "p2" and "p3".
std::optional<std::size_t> fixed_index(std::string_view name) {
  if (name.size() != 2 || name[0] != 'p' || name[1] < '1' || name[1] > '3') return std::nullopt;
  return static_cast<std::size_t>(name[1] - '1');
}

}  // namespace

std::optional<PointColumn> point_column(std::string_view name) {
  const std::size_t unit = name.rfind('_');
  if (unit == std::string_view::npos || unit < 3) return std::nullopt;
  const PointColumn column{name.substr(0, unit - 2), static_cast<std::size_t>(name[unit - 1] - 'x'),
                           name.substr(unit + 1)};
  const bool is_coordinate =
      name[unit - 2] == '_' && name[unit - 1] >= 'x' && name[unit - 1] <= 'z';
  if (!is_coordinate || (column.unit != "m" && column.unit != "mm") ||
      !is_point_name(column.point)) {
    return std::nullopt;
  }
  return column;
}

bool ignores_column(std::string_view ignored, std::string_view name) {
  if (ignored == name) return true;
  if (!ignored.ends_with("_*")) return false;
  const std::optional<PointColumn> column = point_column(name);
  return column && column->point == ignored.substr(0, ignored.size() - 2);
}

void CsvPoints::add(const PointColumn& column) {
  auto point = std::find_if(points_.begin(), points_.end(),
                            [&](const Point& known) { return known.name == column.point; });
  if (point == points_.end()) {
    points_.push_back({std::string(column.point), {}});
    point = points_.end() - 1;
  }
  point->has_axis[column.axis] = true;
}

std::vector<const CsvPoints::Point*> CsvPoints::by_number() const {
  std::vector<const Point*> numbered(std::max(points_.size(), kMostPoints));
  for (const Point& point : points_) {
    if (const auto index = fixed_index(point.name)) numbered[*index] = &point;
  }
  for (const Point& point : points_) {
    if (!fixed_index(point.name)) *std::find(numbered.begin(), numbered.end(), nullptr) = &point;
  }
  return numbered;
}

SampleKind CsvPoints::kind(const std::string& place, bool takes_any_number) const {
  if (points_.size() > kMostPoints && !takes_any_number) {
    const std::vector<Point> surplus(points_.begin() + kMostPoints, points_.end());
    throw InputError(
        place,
        fmt::format("has {} points: {}", points_.size(),
                    short_list(points_, ", ", [](const Point& point) { return point.name; })),
        fmt::format(
            "leave out all but three, for example with {}, or choose one or three with --marker "
            "NAME",
            short_list(surplus, " ", [](const Point& point) {
              return fmt::format("--ignore-column '{}_*'", point.name);
            })));
  }
  std::vector<std::string> lacking;
  for (const Point& point : points_) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!point.has_axis[axis]) lacking.push_back(fmt::format("{}_{}", point.name, "xyz"[axis]));
    }
  }
  const std::vector<const Point*> numbered = by_number();
  if (lacking.empty() && points_.size() >= kMostPoints) return SampleKind::three_points;
  if (lacking.empty() && takes_any_number) return SampleKind::one_point;  // or a choice among two
  if (lacking.empty() && points_.size() == 1 && numbered[0] != nullptr) {
    return SampleKind::one_point;
  }
  if (lacking.empty()) {
    lacking.push_back(points_.size() == 1 ? "p1" : "a third point");
  }
  throw InputError(
      place,
      fmt::format("the position columns are not a complete set: {} {} missing",
                  short_list(lacking, ", ", [](const std::string& name) { return name; }),
                  lacking.size() == 1 ? "is" : "are"),
      "give x, y, z of one point or of three, such as p1_x_mm to p3_z_mm");
}

std::vector<std::string> CsvPoints::names() const {
  std::vector<std::string> names;
  for (const Point* point : by_number()) {
    if (point != nullptr) names.push_back(point->name);
  }
  return names;
}

std::size_t CsvPoints::coordinate(const PointColumn& column) const {
  const std::vector<std::string> all = names();
  const auto point = std::find(all.begin(), all.end(), column.point);
  return 3 * static_cast<std::size_t>(point - all.begin()) + column.axis;
}

std::string CsvPoints::note() const {
  if (std::all_of(points_.begin(), points_.end(),
                  [](const Point& point) { return fixed_index(point.name).has_value(); })) {
    return {};
  }
  // Without a number: in a joined recording it may be point 2 or 3.
  if (points_.size() == 1) return "the point is " + points_[0].name;
  std::vector<std::string> words;
  const std::vector<const Point*> numbered = by_number();
  for (std::size_t i = 0; i < numbered.size(); ++i) {
    if (numbered[i] != nullptr)
      words.push_back(fmt::format("point {} is {}", i + 1, numbered[i]->name));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

TableColumn table_column(const ColumnMeaning& meaning, const std::string& name,
                         const CsvPoints& points, bool has_rate) {
  using Quantity = ColumnMeaning::Quantity;
  using Role = TableColumn::Role;
  TableColumn column;
  column.name = name;
  if (meaning.each > 0) column.per_SI_unit = 1 / meaning.each;
  switch (meaning.quantity) {
    case Quantity::time:
      column.role = Role::time;
      break;
    case Quantity::frame:
      if (has_rate) column.role = Role::frame;
      break;
    case Quantity::one_axis:
      column.role = Role::coordinate;
      break;
    case Quantity::point:
      column.role = Role::coordinate;
      column.coordinate = points.coordinate({meaning.point, meaning.axis, {}});
      break;
    case Quantity::drive:
      column.role = Role::drive;
      break;
    case Quantity::unknown:
    case Quantity::not_read:
      break;
  }
  return column;
}

}  // namespace condyle::host
