// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace condyle {

/// The values that a parameter may have, ends included. NaN is in no range.
struct Range {
  double lowest;
  double highest;
  /// True if `value` is a number in the range.
  constexpr bool contains(double value) const { return value >= lowest && value <= highest; }
};

}  // namespace condyle
