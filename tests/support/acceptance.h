// SPDX-License-Identifier: Apache-2.0
// Bounds that a correct estimator keeps in a number of independent runs, except with the stated
// probability of a false alarm. Fewer runs widen the bound automatically.
#pragma once

#include <cmath>
#include <cstdint>

#include "statistics/chi_square.h"

namespace condyle::testing_support {

/// The fewest hits of `trials` that each hit with `probability`: fewer occur with a probability of
/// at most `false_alarm`.
inline std::uint64_t fewest_hits(std::uint64_t trials, double probability, double false_alarm) {
  std::uint64_t hits = 0;
  const auto seen = static_cast<double>(trials);
  while (host::proportion_interval(static_cast<double>(hits), seen, 1 - 2 * false_alarm).high <=
         probability) {
    ++hits;
  }
  return hits;
}

/// The most hits: more occur with a probability of at most `false_alarm`.
inline std::uint64_t most_hits(std::uint64_t trials, double probability, double false_alarm) {
  return trials - fewest_hits(trials, 1 - probability, false_alarm);
}

/// The largest ratio of the rms of normal errors to their standard deviation.
inline double most_rms_ratio(std::uint64_t errors, double false_alarm) {
  const auto seen = static_cast<double>(errors);
  return std::sqrt(host::chi_square_quantile(1 - false_alarm, seen) / seen);
}

/// The largest distance of the mean of normal errors from 0, in their standard deviations.
inline double most_mean_ratio(std::uint64_t errors, double false_alarm) {
  return host::normal_quantile(1 - false_alarm / 2) / std::sqrt(static_cast<double>(errors));
}

}  // namespace condyle::testing_support
