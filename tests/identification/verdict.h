// SPDX-License-Identifier: Apache-2.0
// What the identification says of a simulated recording, against the truth.
#pragma once

#include <string>

#include "condyle/estimator/impedance/point_identification.h"
#include "identification/regimes.h"

namespace condyle::adversary {

/// Of one value in one run.
struct Verdict {
  bool is_shown = false, is_covered = false;  ///< at the end
  bool was_covered = true;                    ///< in each second that showed it
  double error = 0, sd = 0;
  ImpedanceLimit limit = ImpedanceLimit::none;
};
struct Verdicts {
  Verdict friction, mass;
};

/// What is shown at the end.
Verdict verdict_of(const IdentifiedValue<double>& value, double truth);

Verdicts judge(const Attack& attack, std::uint64_t seed);

/// Of one value in many runs.
struct Tally {
  int runs = 0, shown = 0, covered = 0, always_covered = 0;
  double error_square = 0, sd = 0;
  int limits[kImpedanceLimits] = {};

  void add(const Verdict& verdict);
  double covered_share() const { return shown > 0 ? static_cast<double>(covered) / shown : 1; }
};

/// A line of the table that a test prints.
std::string line_of(const char* name, const char* value, const Tally& tally);
/// A test's name.
std::string name_of(std::size_t index, const char* name);

}  // namespace condyle::adversary
