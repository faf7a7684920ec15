// SPDX-License-Identifier: Apache-2.0
// Medians and quantiles of values in any order. A quantile is one of the values, so it needs no
// arithmetic and exists for times in whole nanoseconds, too.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace condyle::host {

/// The element at `place` of the sorted `values`, which must have more elements than that. Changes
/// their order.
template <class Value>
Value sorted_at(std::vector<Value>& values, std::size_t place) {
  const auto at = std::next(values.begin(), static_cast<std::ptrdiff_t>(place));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The middle of the sorted `values`, which must not be empty; the upper of two if their number is
/// even.
template <class Value>
Value upper_median(std::vector<Value> values) {
  return sorted_at(values, values.size() / 2);
}

/// The value at the rank `share` (0 to 1) times (count - 1), rounded down, of the sorted `values`,
/// which must not be empty.
template <class Value>
Value lower_quantile(std::vector<Value> values, double share) {
  const auto place = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  return sorted_at(values, place);
}

}  // namespace condyle::host
