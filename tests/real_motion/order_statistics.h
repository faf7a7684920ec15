// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace condyle::testing_support {

/// The quantile of the finite `values` at `share` (0 to 1), linear between neighbours; NaN where
/// none is finite.
inline double quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return std::nan("");
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::ptrdiff_t>(at);
  const auto low = values.begin() + below;
  std::nth_element(values.begin(), low, values.end());
  if (low + 1 == values.end()) return *low;
  const double next = *std::min_element(low + 1, values.end());
  return *low + (at - static_cast<double>(below)) * (next - *low);
}

inline double median(const std::vector<double>& values) {
  return quantile(values, 0.5);
}

/// The smallest and the largest of the finite `values`.
inline std::pair<double, double> finite_range(const std::vector<double>& values) {
  return {quantile(values, 0), quantile(values, 1)};
}

}  // namespace condyle::testing_support
