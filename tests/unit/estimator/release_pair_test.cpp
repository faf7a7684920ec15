// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/release/release_pair.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/release_samples.h"

namespace condyle {
namespace {

using testing_support::fit;
using testing_support::release_samples;
using testing_support::ReleaseTruth;

// kv = 2 Ns/m, ks = 100 N/m, m = 0.25 kg, with a load; noise far below what is stated
// (none at all would leave rounding, whose neighbours are alike).
PassiveRelease<double> release_with(double dm, double dk, double W, double scatter = 1) {
  ReleaseTruth truth;
  truth.lambda_per_s = 2 * scatter / (0.25 + dm);
  truth.kappa_per_s2 = (100 + dk) / (0.25 + dm);
  truth.rest_m += W / 100;
  return fit(release_samples(truth, 1e-7, 1), {.noise_sd_m = 2e-5});
}

TEST(ReleasePair, FindsTheTruthWithEachLoad) {
  struct Load {
    double dm, dk, W;
  };
  for (const Load load : {Load{0.1, 0, 0}, Load{-0.05, 0, 0}, Load{0, 80, 0}, Load{0, 0, 0.5},
                          Load{0.1, 50, 0}, Load{0.1, 0, -0.981}}) {
    ReleasePairSettings settings;
    settings.load = {{load.dm, 0}, {load.dk, 0}, {load.W, 0}};
    const auto pair =
        combine_releases(release_with(0, 0, 0), release_with(load.dm, load.dk, load.W), settings);
    ASSERT_EQ(pair.outcome, ReleasePairOutcome::combined) << load.dm << ' ' << load.dk;
    EXPECT_NEAR(pair.friction_Ns_m.quantity.value, 2, 1e-3);
    EXPECT_NEAR(pair.stiffness_N_m.quantity.value, 100, 0.05);
    EXPECT_NEAR(pair.mass_kg.quantity.value, 0.25, 1e-4);
    EXPECT_EQ(pair.mass_kg.quantity.provenance, Provenance::measured);
  }
}

// The load may be taken off instead of put on, also one that is heavier than the jaw: the same
// friction and stiffness, and the mass is that of the first recording.
TEST(ReleasePair, MayBeginWithTheLoad) {
  for (const double dm : {0.02, 0.1, 0.2, 0.3, 0.5, 1.0}) {
    const auto without = release_with(0, 0, 0), with = release_with(dm, 0, 0);
    ReleasePairSettings settings;
    settings.load.mass_kg = {dm, 0};
    const auto put_on = combine_releases(without, with, settings);
    settings.load.mass_kg = {-dm, 0};
    const auto taken_off = combine_releases(with, without, settings);
    ASSERT_EQ(put_on.outcome, ReleasePairOutcome::combined) << dm;
    ASSERT_EQ(taken_off.outcome, ReleasePairOutcome::combined) << dm;
    EXPECT_NEAR(taken_off.mass_kg.quantity.value, put_on.mass_kg.quantity.value + dm, 1e-7);
    for (const auto value :
         {&ReleasePair<double>::friction_Ns_m, &ReleasePair<double>::stiffness_N_m}) {
      const auto expected = put_on.*value, actual = taken_off.*value;
      EXPECT_NEAR(actual.quantity.value / expected.quantity.value, 1, 1e-6) << dm;
      EXPECT_NEAR(actual.low95 / expected.low95, 1, 1e-3) << dm;
      EXPECT_NEAR(actual.high95 / expected.high95, 1, 1e-3) << dm;
    }
  }
}

// Both releases are known, so the outcome is one of the pair.
TEST(ReleasePair, RecordingsInTheWrongOrderGiveNoValue) {
  struct Load {
    double dm, dk, W;
  };
  int not_converged = 0;
  for (const Load load :
       {Load{0.05, 0, 0}, Load{0.1, 0, 0}, Load{0.3, 0, 0}, Load{1, 0, 0}, Load{-0.1, 0, 0},
        Load{0, 80, 0}, Load{0, 0, 0.5}, Load{0.1, 0, -0.981}}) {
    ReleasePairSettings settings;
    settings.load = {{load.dm, 0}, {load.dk, 0}, {load.W, 0}};
    const auto pair =
        combine_releases(release_with(load.dm, load.dk, load.W), release_with(0, 0, 0), settings);
    EXPECT_NE(pair.outcome, ReleasePairOutcome::release_not_known) << load.dm << ' ' << load.dk;
    not_converged += pair.outcome == ReleasePairOutcome::not_converged ? 1 : 0;
    EXPECT_TRUE(std::isnan(pair.mass_kg.quantity.value));
    EXPECT_TRUE(std::isnan(pair.friction_Ns_m.quantity.value));
    EXPECT_TRUE(std::isnan(pair.stiffness_N_m.quantity.value));
  }
  EXPECT_GT(not_converged, 0);
}

// A load that is known to 10 % gives a mass to 10 %, whose interval reaches further up than down:
// its wider half, 1 / (1 - 0.196) - 1, counts.
TEST(ReleasePair, LoadsUncertaintyWidensTheInterval) {
  ReleasePairSettings settings;
  settings.load.mass_kg = {0.1, 0.01};
  const auto pair = combine_releases(release_with(0, 0, 0), release_with(0.1, 0, 0), settings);
  EXPECT_NEAR(pair.mass_kg.quantity.standard_deviation / 0.25, 0.1244, 0.005);
  EXPECT_EQ(pair.mass_kg.quantity.provenance, Provenance::assumed);
}

TEST(ReleasePair, SaysWhereTheRecordingsDisagree) {
  ReleasePairSettings settings;
  settings.load.mass_kg = {0.1, 0.001};
  const auto pair = combine_releases(release_with(0, 0, 0), release_with(0.1, 0, 0, 1.1), settings);
  EXPECT_EQ(pair.outcome, ReleasePairOutcome::disagree);
  EXPECT_GT(pair.chi_square, 10.83);
  EXPECT_TRUE(std::isnan(pair.mass_kg.quantity.value));
  settings.load.mass_kg = {0.5, 0.001};  // not the load that was put on
  const auto wrong = combine_releases(release_with(0, 0, 0), release_with(0.1, 30, 0), settings);
  EXPECT_EQ(wrong.outcome, ReleasePairOutcome::disagree);
}

// Fieller's: where the difference of a and x b is q of its standard deviations.
TEST(ReleasePair, ARatiosIntervalEndsWhereFiellerSays) {
  const double a = 3, b = 2, aa = 0.04, ab = 0.01, bb = 0.02, q = 1.96;
  const auto [low, high] = internal::ratio_interval(a, b, aa, ab, bb, q);
  for (const double x : {low, high}) {
    EXPECT_NEAR(std::abs(a - x * b), q * std::sqrt(aa - 2 * x * ab + x * x * bb), 1e-12);
  }
  EXPECT_LT(low, a / b);
  EXPECT_GT(high, a / b);
  const auto unknown = internal::ratio_interval(a, 0.2, aa, ab, bb, q);  // b may be 0
  EXPECT_EQ(unknown.first, -INFINITY);
  EXPECT_EQ(unknown.second, INFINITY);
}

// A load without effect: the mass has no upper end.
TEST(ReleasePair, SaysSoWhereTheLoadIsTooSmall) {
  ReleasePairSettings settings;
  settings.load.mass_kg = {1e-4, 0};
  const auto pair = combine_releases(release_with(0, 0, 0), release_with(1e-4, 0, 0), settings);
  EXPECT_EQ(pair.outcome, ReleasePairOutcome::combined);
  EXPECT_TRUE(std::isnan(pair.mass_kg.quantity.value));
  EXPECT_EQ(pair.mass_kg.quantity.provenance, Provenance::not_computed);
}

TEST(ReleasePair, RefusesLoadsAndReleasesThatItCannotUse) {
  const auto release = release_with(0, 0, 0);
  const auto outcome = [&](const ReleaseLoad& load) {
    ReleasePairSettings settings;
    settings.load = load;
    return combine_releases(release, release, settings).outcome;
  };
  EXPECT_EQ(outcome({}), ReleasePairOutcome::unusable_load);
  EXPECT_EQ(outcome({.mass_kg = {NAN, 0}}), ReleasePairOutcome::unusable_load);
  EXPECT_EQ(outcome({.mass_kg = {0.1, -1}}), ReleasePairOutcome::unusable_load);
  EXPECT_EQ(outcome({.mass_kg = {}, .stiffness_N_m = {10, 0}, .weight_N = {1, 0}}),
            ReleasePairOutcome::unusable_load);
  ReleasePairSettings settings;
  settings.load.mass_kg = {0.1, 0};
  EXPECT_EQ(combine_releases(release, PassiveRelease<double>{}, settings).outcome,
            ReleasePairOutcome::release_not_known);
}

}  // namespace
}  // namespace condyle
