// SPDX-License-Identifier: Apache-2.0
#include "recordings/mat_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace condyle::host {
namespace {

std::string lower_without_joints(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '_' || c == '.') continue;
    result += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return result;
}

template <std::size_t count>
bool is_one_of(std::string_view name, const std::array<std::string_view, count>& words) {
  const std::string word = lower_without_joints(name);
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

bool is_rate(const NamedArray& one) {
  constexpr std::array<std::string_view, 16> kRates{"fs",
                                                    "fps",
                                                    "rate",
                                                    "ratehz",
                                                    "srate",
                                                    "framerate",
                                                    "framefrequency",
                                                    "samplerate",
                                                    "samplingrate",
                                                    "fshz",
                                                    "frequencyhz",
                                                    "samplefrequency",
                                                    "samplingfrequency",
                                                    "sampleratehz",
                                                    "samplingratehz",
                                                    "frameratehz"};
  return is_one_of(one.name, kRates) && std::isfinite(one.array.scalar());
}
bool is_unit(const NamedArray& one) {
  constexpr std::array<std::string_view, 4> kUnits{"unit", "units", "positionunit", "lengthunit"};
  return is_one_of(one.name, kUnits) && !one.array.text().empty();
}
bool are_labels(const NamedArray& one) {
  constexpr std::array<std::string_view, 8> kLabels{"label", "labels",      "marker", "markers",
                                                    "names", "markernames", "points", "pointnames"};
  return is_one_of(one.name, kLabels) && !one.array.texts().empty();
}

bool is_vector(const MatArray& array) {
  const std::vector<std::size_t> sizes = array.sizes();
  return array.is_numeric() && sizes.size() == 2 && std::min(sizes[0], sizes[1]) == 1 &&
         array.count() > 1;
}

std::size_t longest(const MatArray& array) {
  const std::vector<std::size_t> sizes = array.sizes();
  return *std::max_element(sizes.begin(), sizes.end());
}

std::optional<MatShape> shape_of(const MatArray& array, std::optional<std::size_t> rows) {
  if (!array.is_numeric()) return std::nullopt;
  const std::vector<std::size_t> sizes = array.sizes();
  const std::size_t wanted = rows.value_or(longest(array));
  if (wanted < 2 || sizes.size() > 3 || std::count(sizes.begin(), sizes.end(), wanted) != 1) {
    return std::nullopt;
  }
  const std::array<std::size_t, 3> strides{1, sizes[0], sizes[0] * sizes[1]};
  MatShape shape;
  shape.rows = wanted;
  const auto row =
      static_cast<std::size_t>(std::find(sizes.begin(), sizes.end(), wanted) - sizes.begin());
  shape.row_stride = strides[row];
  if (sizes.size() == 2) {
    const std::size_t other = 1 - row;
    if (sizes[other] == 0 || sizes[other] % 3 != 0) return std::nullopt;
    shape.points = sizes[other] / 3;
    shape.axis_stride = strides[other];
    shape.point_stride = 3 * strides[other];
    return shape;
  }
  const std::size_t a = row == 0 ? 1 : 0, b = row == 2 ? 1 : 2;
  // Rotation matrices and what is not x, y, z.
  if ((sizes[a] == 3) == (sizes[b] == 3)) return std::nullopt;
  const std::size_t axis = sizes[a] == 3 ? a : b, point = axis == a ? b : a;
  shape.points = sizes[point];
  shape.axis_stride = strides[axis];
  shape.point_stride = strides[point];
  return shape;
}

}  // namespace condyle::host
