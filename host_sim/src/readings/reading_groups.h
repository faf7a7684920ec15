// SPDX-License-Identifier: Apache-2.0
// Readings that rest on the same assumption, by their names.
#pragma once

#include <string_view>

namespace condyle::host {

/// Whether the condylar points decide on it.
inline bool is_condylar(std::string_view name) {
  for (const std::string_view word :
       {"condylar", "bennett", "side_shift", "working", "fischer", "per_translation"}) {
    if (name.find(word) != std::string_view::npos) return true;
  }
  return false;
}

/// Whether a smoothing instrument makes it smaller.
inline bool is_fast(std::string_view name) {
  for (const std::string_view word :
       {"speed", "sparc", "ldlj", "cycle_height", "cycle_width", "cycle_path", "_area_"}) {
    if (name.find(word) != std::string_view::npos) return true;
  }
  return false;
}

/// Whether a movement of a few samples decides on it.
inline bool is_of_short_movements(std::string_view name) {
  for (const std::string_view word :
       {"peak_", "sparc", "ldlj", "instantaneous", "condylar_path", "cycle_path"}) {
    if (name.find(word) != std::string_view::npos) return true;
  }
  return false;
}

/// Whether a mistaken place of the landmarks changes it: all but times and counts.
inline bool is_place(std::string_view unit) {
  return unit != "s" && unit != "Hz" && unit != "1" && !unit.empty();
}

}  // namespace condyle::host
