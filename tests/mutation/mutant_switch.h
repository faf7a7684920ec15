// SPDX-License-Identifier: Apache-2.0
// Included before every file of the mutated build: which mutant the environment chooses, and which
// mutants a test reaches. In constant expressions no mutant is chosen.
#pragma once

#include <array>
#include <atomic>
#include <cstdlib>
#include <type_traits>

namespace condyle_mutation {

inline constexpr int kMutants = 1024;
inline constinit std::array<std::atomic<bool>, kMutants> reached = {};

inline const int chosen = [] {
  const char* number = std::getenv("CONDYLE_MUTANT");
  return number == nullptr ? 0 : std::atoi(number);
}();

constexpr bool is_chosen(int mutant) {
  if (std::is_constant_evaluated()) return false;
  reached[static_cast<unsigned>(mutant)].store(true, std::memory_order_relaxed);
  return chosen == mutant;
}

}  // namespace condyle_mutation
