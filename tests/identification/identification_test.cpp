// SPDX-License-Identifier: Apache-2.0
// The identification against recordings that another simulator made (adversary.h): what it shows
// holds the truth, or it shows nothing.
//
// A row fails where fewer of the shown values hold the truth than intervals of 90 % would leave
// once in 1000 times, unless less than 3 % of the runs show one. Intervals of 95 % fail a row of
// 200 once in 10^6 times, shorter ones less often. The seeds are fixed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "identification/precision_bound.h"
#include "identification/verdict.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::adversary {
namespace {

using testing_support::fewest_hits;
using testing_support::runs;

constexpr double kFalseAlarm = 1e-3, kSeldom = 0.03;

void expect_covered(const Tally& tally, double share) {
  if (tally.shown < kSeldom * tally.runs) return;
  EXPECT_GE(static_cast<std::uint64_t>(tally.covered),
            fewest_hits(static_cast<std::uint64_t>(tally.shown), share, kFalseAlarm));
}

bool is_clean(const Attack& attack) {
  return std::string_view(attack.regime.name).starts_with("clean");
}

class Named : public testing::TestWithParam<Attack> {};

TEST_P(Named, IsCoveredOrWithheld) {
  const Attack& attack = GetParam();
  const int kRuns = attack.regime.duration_s > 200 ? runs(2, 3, 200) : runs(3, 8, 200);
  Tally friction, mass;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const Verdicts verdicts = judge(attack, static_cast<std::uint64_t>(seed));
    friction.add(verdicts.friction);
    mass.add(verdicts.mass);
  }
  std::cout << line_of(attack.regime.name, "friction", friction)
            << line_of(attack.regime.name, "mass", mass);
  if (attack.cannot_be_had != nullptr) return;
  expect_covered(friction, 0.9);
  expect_covered(mass, 0.9);
  if (!is_clean(attack) || attack.regime.duration_s > 60) return;
  // No second on the way excludes the truth in 90 % of the runs.
  for (const Tally& tally : {friction, mass}) {
    EXPECT_GE(static_cast<std::uint64_t>(tally.always_covered),
              fewest_hits(static_cast<std::uint64_t>(tally.runs), 0.9, kFalseAlarm));
  }
}
INSTANTIATE_TEST_SUITE_P(Regimes, Named, testing::ValuesIn(named_attacks()),
                         [](const testing::TestParamInfo<Attack>& test) {
                           return name_of(test.index, test.param.regime.name);
                         });

class Drawn : public testing::TestWithParam<RandomClass> {};

TEST_P(Drawn, IsCoveredWhereItIsShown) {
  const RandomClass& of = GetParam();
  const int kShown = runs(6, 24, 500), kMost = runs(40, 160, 4000);
  Tally friction, mass;
  for (int seed = 1; seed <= kMost && (friction.shown < kShown || mass.shown < kShown); ++seed) {
    const auto at = static_cast<std::uint64_t>(seed);
    const Verdicts verdicts = judge(random_attack(of, at), at);
    friction.add(verdicts.friction);
    mass.add(verdicts.mass);
  }
  std::cout << line_of(of.name, "friction", friction) << line_of(of.name, "mass", mass);
  const double share = of.has_unsaid_error ? 0.88 : 0.92;
  expect_covered(friction, share);
  expect_covered(mass, share);
}
INSTANTIATE_TEST_SUITE_P(Classes, Drawn,
                         testing::Values(RandomClass{"known delay, clean", false, false},
                                         RandomClass{"known delay, unsaid error", true, false},
                                         RandomClass{"fitted delay, clean", false, true},
                                         RandomClass{"fitted delay, unsaid error", true, true}));

// Errors against the bound, the drawn gain and delay left out: a rms of n runs strays by
// 1 / sqrt(2 n), and passes 3.3 of that once in 1000 times.
TEST(Clean, IsNearlyAsGoodAsCanBe) {
  const int kRuns = runs(10, 20, 200);
  for (const double rate_Hz : {60.0, 200.0}) {
    Attack attack;
    attack.regime.tracker.rate_Hz = attack.regime.drive.rate_Hz = rate_Hz;
    attack.said.delay_sd_s = attack.said.gain_sd = 0;
    double friction2 = 0, mass2 = 0;
    int shown = 0;
    for (int seed = 1; seed <= kRuns; ++seed) {
      const auto at = static_cast<std::uint64_t>(seed);
      const PrecisionBound bound = precision_bound(attack.regime, at);
      const Verdicts verdicts = judge(attack, at);
      shown += verdicts.friction.is_shown && verdicts.mass.is_shown ? 1 : 0;
      friction2 += std::pow(verdicts.friction.error / bound.friction_Ns_m, 2) / kRuns;
      mass2 += std::pow(verdicts.mass.error / bound.mass_kg, 2) / kRuns;
    }
    const double chance = 1 + 3.3 / std::sqrt(2.0 * kRuns);
    std::cout << fmt::format(
        "{} Hz: friction {:.2f}, mass {:.2f} times the bound; shown {} of {}\n", rate_Hz,
        std::sqrt(friction2), std::sqrt(mass2), shown, kRuns);
    EXPECT_LT(std::sqrt(friction2), 1.15 * chance);
    EXPECT_LT(std::sqrt(mass2), 1.7 * chance);
    EXPECT_GE(static_cast<std::uint64_t>(shown),
              fewest_hits(static_cast<std::uint64_t>(kRuns), 0.95, kFalseAlarm));
  }
}

}  // namespace
}  // namespace condyle::adversary
