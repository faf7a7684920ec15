// SPDX-License-Identifier: Apache-2.0
// What a right estimator keeps to in some independent runs, but for a stated probability: that of a
// false alarm. Fewer runs widen the bound by themselves.
#pragma once

#include <cmath>
#include <cstdint>

#include "statistics/chi_square.h"

namespace condyle::testing_support {

/// The fewest hits of `trials` that each hit with `probability`: fewer are seen with `false_alarm`
/// at most.
inline std::uint64_t fewest_hits(std::uint64_t trials, double probability, double false_alarm) {
  std::uint64_t hits = 0;
  const auto seen = static_cast<double>(trials);
  while (host::proportion_interval(static_cast<double>(hits), seen, 1 - 2 * false_alarm).high <=
         probability) {
    ++hits;
  }
  return hits;
}

/// The most hits: more are seen with `false_alarm` at most.
inline std::uint64_t most_hits(std::uint64_t trials, double probability, double false_alarm) {
  return trials - fewest_hits(trials, 1 - probability, false_alarm);
}

/// The largest ratio of the rms of normal errors to their standard deviation.
inline double most_rms_ratio(std::uint64_t errors, double false_alarm) {
  const auto seen = static_cast<double>(errors);
  return std::sqrt(host::chi_square_quantile(1 - false_alarm, seen) / seen);
}

/// The farthest from 0 that the mean of normal errors is, of their standard deviation.
inline double most_mean_ratio(std::uint64_t errors, double false_alarm) {
  return host::normal_quantile(1 - false_alarm / 2) / std::sqrt(static_cast<double>(errors));
}

}  // namespace condyle::testing_support
