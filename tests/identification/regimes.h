// SPDX-License-Identifier: Apache-2.0
// The regimes that the identification is attacked with: named ones, and classes of random ones.
#pragma once

#include <vector>

#include "condyle/estimator/impedance/impedance_parameters.h"
#include "identification/adversary.h"

namespace condyle::adversary {

/// What the user states, beside the default.
struct Statement {
  bool fits_delay = false;
  double delay_sd_s = 5e-4, gain_sd = 0.01;
  double delay_s = 0;
};

/// A regime with what is said of it. Gain and delay are drawn from what is stated.
struct Attack {
  Regime regime;
  Statement said;
  /// Of values that cannot be had, why (README of this folder); coverage is then not asked for.
  const char* cannot_be_had = nullptr;
};

ImpedanceParameters parameters_of(const Statement& said);

/// Draws gain and delay from what is stated.
Regime drawn(const Attack& attack, std::uint64_t seed);

const std::vector<Attack>& named_attacks();

/// Random regimes.
struct RandomClass {
  const char* name;
  bool has_unsaid_error, fits_delay;
};
Attack random_attack(const RandomClass& of, std::uint64_t seed);

}  // namespace condyle::adversary
