// SPDX-License-Identifier: Apache-2.0
// What the cycles of a chewing task have in common: side, scatter, change.
//
// Side of a cycle: stated with the task, else by its closing side (cycle_shape.h): below
// max(1 mm, 2 sd) midline. Loop reversed: it closes nearer to the midline than it opens.
// Counts have as interval the cycles that surely are so and those that may be.
// Scatter: standard deviation without that of the measurement, not below 0.
// Change: of these cycles; whether they only scatter, its remark helps to judge.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "readings/analysis.h"

namespace condyle::host {

/// A reading of all cycles that are taken.
struct CycleSummary {
  std::string_view name;
  Side side = Side::none;
  UncertainValue value;
  std::optional<std::array<double, 2>> interval;  ///< if it does not lie about the value
  std::string remark;      ///< what the value takes for granted, or how to read it
  bool is_derived = true;  ///< if there is a remark: by what it says
};

/// Says the side of each cycle that is taken, with a note if the task states it.
void find_sides(Analysis& analysis);

/// Their scatter, change, sides and loops. Call find_sides before.
std::vector<CycleSummary> summaries_of(const Analysis& analysis);

}  // namespace condyle::host
