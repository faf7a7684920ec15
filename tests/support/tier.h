// SPDX-License-Identifier: Apache-2.0
// How much of a long test runs, by the environment variable CONDYLE_TIER.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace condyle::testing_support {

/// In order of length.
enum class Tier {
  check,    ///< after each edit
  full,     ///< continuous integration
  release,  ///< before a release: every statistic at its full length
};

/// The tier that `word` names; check if it is null. Aborts if it does not name one.
inline Tier tier_of(const char* word) {
  const std::string_view name = word == nullptr ? "check" : word;
  if (name == "check") return Tier::check;
  if (name == "full") return Tier::full;
  if (name == "release") return Tier::release;
  std::fprintf(stderr, "CONDYLE_TIER is \"%s\": set it to check, full or release, or unset it\n",
               word);
  std::abort();
}

/// The tier of this process.
inline Tier tier() {
  static const Tier of_process = tier_of(std::getenv("CONDYLE_TIER"));
  return of_process;
}

inline bool tier_is_at_least(Tier least) {
  return tier() >= least;
}

/// How many runs a test takes.
template <class Count>
Count runs(Count check, Count full, Count release) {
  switch (tier()) {
    case Tier::check:
      return check;
    case Tier::full:
      return full;
    case Tier::release:
      break;
  }
  return release;
}

}  // namespace condyle::testing_support
