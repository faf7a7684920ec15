// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>

namespace condyle::host {

/// A generator of random numbers: normal() standard normal, uniform() in [0, 1).
template <class Random>
concept RandomSource = requires(Random random) {
  { random.normal() } -> std::convertible_to<double>;
  { random.uniform() } -> std::convertible_to<double>;
};

}  // namespace condyle::host
