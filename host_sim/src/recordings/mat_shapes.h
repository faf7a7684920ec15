// SPDX-License-Identifier: Apache-2.0
// What the names and the sizes of arrays in a MAT file tell.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recordings/mat_file.h"

namespace condyle::host {

/// An array with its name in its struct.
struct NamedArray {
  std::string name;
  MatArray array;
};

/// The variables of the file, or the fields of one struct.
struct MatGroup {
  std::string prefix;  ///< "trial.": before the names of its arrays
  std::vector<NamedArray> arrays;

  bool is_around(const MatGroup& other) const {
    return prefix.size() < other.prefix.size() && other.prefix.starts_with(prefix);
  }
};

/// Where the coordinates of an array are.
struct MatShape {
  std::size_t points = 0, rows = 0, point_stride = 0, axis_stride = 0, row_stride = 0;
};

/// A number that its name calls the rate of samples.
bool is_rate(const NamedArray& one);
/// A text that its name calls a unit.
bool is_unit(const NamedArray& one);
/// Texts that their name calls those of points.
bool are_labels(const NamedArray& one);
/// Numbers in one row or one column.
bool is_vector(const MatArray& array);
/// The longest side.
std::size_t longest(const MatArray& array);
/// How `array` holds points in `rows` rows; without `rows`, its longest side has them. None if it
/// does not, or may do so in two ways.
std::optional<MatShape> shape_of(const MatArray& array, std::optional<std::size_t> rows);

}  // namespace condyle::host
