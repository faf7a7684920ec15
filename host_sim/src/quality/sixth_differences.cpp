// SPDX-License-Identifier: Apache-2.0
#include "quality/sixth_differences.h"

#include <cmath>

#include "statistics/quantile.h"

namespace condyle::host {

double noise_by_sixth_differences(std::vector<double> values) {
  for (int order = 0; order < 6; ++order) {
    for (std::size_t i = 0; i + 1 < values.size(); ++i) values[i] = values[i + 1] - values[i];
    values.pop_back();
  }
  for (double& difference : values) difference = std::abs(difference);
  return upper_median(std::move(values)) / (0.6745 * std::sqrt(924.0));
}

}  // namespace condyle::host
