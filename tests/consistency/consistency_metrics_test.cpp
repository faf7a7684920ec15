// SPDX-License-Identifier: Apache-2.0
// The ruler is tested in both directions: a right filter is called right, a spoilt one wrong.
//
// Each check on the right filter has a false-alarm probability of 0.1 %. The seeds are fixed, so
// the outcome is too; with other seeds the 24 checks together would fail about once in 40.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "consistency/linear_gaussian_toy.h"
#include "evaluation/response_slope.h"
#include "statistics/monte_carlo.h"
#include "support/random.h"

namespace condyle::host {
namespace {

using testing_support::Random;
constexpr double kConfidence = 0.999;

ToyStatistics evaluate(const ToySpoilt& spoilt, std::uint64_t runs, std::uint64_t first_seed,
                       unsigned threads = 0) {
  const ToySystem system;
  ToyStatistics statistics;
  run_monte_carlo(
      runs, first_seed,
      [&](std::uint64_t seed) {
        Random random(seed);
        return run_toy(system, spoilt, random);
      },
      [&](const ToyRun& run) { statistics.add_run(run); }, {}, {.threads = threads});
  return statistics;
}

double ratio(const ErrorStatistics& last, int state) {
  return ratio_to_bound(last.report(kConfidence).rms, toy_bound(ToySystem())(state, state));
}

constexpr std::uint64_t kRuns = 2000;

TEST(Ruler, CallsTheRightFilterRight) {
  const ToyStatistics toy = evaluate({}, kRuns, 1);
  EXPECT_TRUE(toy.last_nees.report(kConfidence).inside);
  EXPECT_TRUE(toy.nees.report(kConfidence).inside);
  EXPECT_TRUE(toy.nis.report(kConfidence).inside);
  EXPECT_EQ(toy.nis.report(kConfidence).terms, kRuns * 60);
  const double allowed = normal_quantile((1 + kConfidence) / 2);
  const Interval ratio_bounds = ratio_to_bound_bounds(kRuns, kConfidence);
  const ErrorStatistics* last[] = {&toy.last_position_m, &toy.last_velocity_m_s,
                                   &toy.last_acceleration_m_s2};
  const ErrorStatistics* all[] = {&toy.position_m, &toy.velocity_m_s, &toy.acceleration_m_s2};
  for (int state = 0; state < 3; ++state) {
    const ErrorReport one = last[state]->report(kConfidence);
    EXPECT_TRUE(one.coverage_is_nominal) << one.coverage;
    EXPECT_TRUE(one.normalised_square_is_inside) << one.mean_normalised_square;
    EXPECT_LT(std::abs(one.bias), allowed * one.bias_standard_error);
    EXPECT_TRUE(ratio_bounds.contains(ratio(*last[state], state)));
    const ErrorReport more = all[state]->report(kConfidence);
    EXPECT_TRUE(more.coverage_is_nominal) << more.coverage;
    EXPECT_TRUE(more.normalised_square_is_inside) << more.mean_normalised_square;
    EXPECT_LT(std::abs(more.bias), allowed * more.bias_standard_error);
  }
}

TEST(Ruler, NoticesWhatASpoiltFilterClaims) {
  const struct {
    const char* name;
    ToySpoilt spoilt;
    bool overconfident;
    ErrorStatistics ToyStatistics::*hit;  // the quantity that it spoils most
  } cases[] = {
      {"measurement noise claimed too small",
       {.claimed_position_noise = 0.7},
       true,
       &ToyStatistics::last_position_m},
      {"measurement noise claimed too large",
       {.claimed_position_noise = 1.4},
       false,
       &ToyStatistics::last_position_m},
      {"process noise claimed too small",
       {.claimed_jerk_density = 0.3},
       true,
       &ToyStatistics::last_acceleration_m_s2},
      {"process noise claimed too large",
       {.claimed_jerk_density = 3},
       false,
       &ToyStatistics::last_acceleration_m_s2},
  };
  for (const auto& one : cases) {
    const ToyStatistics toy = evaluate(one.spoilt, kRuns, 1);
    const auto nees = toy.last_nees.report(kConfidence), nis = toy.nis.report(kConfidence);
    for (const auto& report : {nees, toy.nees.report(kConfidence), nis}) {
      EXPECT_FALSE(report.inside) << one.name;
      EXPECT_EQ(report.mean > report.bounds.high, one.overconfident) << one.name;
    }
    for (const auto* quantity : {&toy.velocity_m_s, &(toy.*one.hit)}) {
      const ErrorReport report = quantity->report(kConfidence);
      EXPECT_FALSE(report.coverage_is_nominal) << one.name;
      EXPECT_EQ(report.coverage < kNominalCoverage, one.overconfident) << one.name;
      EXPECT_FALSE(report.normalised_square_is_inside) << one.name;
    }
  }
}

TEST(Ruler, NoticesWhatASpoiltFilterLoses) {
  const Interval bounds = ratio_to_bound_bounds(kRuns, kConfidence);
  EXPECT_GT(ratio(evaluate({.claimed_position_noise = 0.3}, kRuns, 1).last_velocity_m_s, 1),
            bounds.high);
  EXPECT_GT(ratio(evaluate({.claimed_jerk_density = 0.01}, kRuns, 1).last_velocity_m_s, 1),
            bounds.high);
  EXPECT_GT(ratio(evaluate({.sensor_bias_m = 1e-4}, kRuns, 1).last_position_m, 0), bounds.high);
}

// The errors tell; no innovation does, for a displaced sensor and a displaced jaw look the same.
TEST(Ruler, NoticesABiasedSensorInTheErrorsAlone) {
  const ToyStatistics toy = evaluate({.sensor_bias_m = 1e-4}, kRuns, 1);
  EXPECT_FALSE(toy.last_nees.report(kConfidence).inside);
  EXPECT_TRUE(toy.nis.report(kConfidence).inside);
  const ErrorReport position = toy.last_position_m.report(kConfidence);
  EXPECT_FALSE(position.coverage_is_nominal);
  EXPECT_NEAR(position.bias, 1e-4, 4 * position.bias_standard_error);
  EXPECT_GT(position.bias, 10 * position.bias_standard_error);
}

// How often the ruler itself is wrong: bounds of 95 % must hold in 95 % of evaluations, those of a
// coverage, which is discrete, in no fewer. Each count may stray as 99.9 % of binomial ones do.
TEST(Ruler, IsWrongAsOftenAsItSays) {
  constexpr int kEvaluations = 500;
  constexpr std::uint64_t kRunsEach = 40;
  double nees = 0, nis = 0, bias = 0, square = 0, coverage = 0, all_coverage = 0, slope = 0;
  const double allowed = student_t_quantile(0.975, kRunsEach - 1);
  for (int i = 0; i < kEvaluations; ++i) {
    const std::uint64_t first_seed = 10000 + kRunsEach * static_cast<std::uint64_t>(i);
    const ToyStatistics toy = evaluate({}, kRunsEach, first_seed);
    nees += toy.last_nees.report(0.95).inside;
    nis += toy.nis.report(0.95).inside;
    const ErrorReport velocity = toy.velocity_m_s.report(0.95);
    bias += std::abs(velocity.bias) <= allowed * velocity.bias_standard_error;
    square += toy.last_velocity_m_s.report(0.95).normalised_square_is_inside;
    coverage += toy.last_velocity_m_s.report(0.95).coverage_is_nominal;
    all_coverage += velocity.coverage_is_nominal;
    Random random(first_seed);
    ResponseSlope line;
    for (int k = 0; k < 10; ++k) line.add(k, 2 + 0.3 * k + random.normal());
    slope += line.report(0.95).slope_interval.contains(0.3);
  }
  const double scatter = normal_quantile(0.9995) * std::sqrt(0.95 * 0.05 * kEvaluations);
  const Interval expected{0.95 * kEvaluations - scatter, 0.95 * kEvaluations + scatter};
  for (const double count : {nees, nis, bias, square, slope}) {
    EXPECT_TRUE(expected.contains(count)) << count;
  }
  for (const double count : {coverage, all_coverage}) EXPECT_GE(count, expected.low);
}

TEST(Ruler, SaysTheSameBitsForEveryNumberOfThreads) {
  const auto bits = [](unsigned threads) {
    const ToyStatistics toy = evaluate({}, 300, 1, threads);
    const auto nees = toy.nees.report(0.95), nis = toy.nis.report(0.95);
    const auto velocity = toy.velocity_m_s.report(0.95);
    return std::array{nees.mean,         nees.standard_error,
                      nis.mean,          nis.standard_error,
                      velocity.rms,      velocity.rms_standard_error,
                      velocity.bias,     velocity.bias_standard_error,
                      velocity.coverage, velocity.mean_normalised_square};
  };
  const auto one = bits(1);
  EXPECT_EQ(bits(2), one);
  EXPECT_EQ(bits(5), one);
}

}  // namespace
}  // namespace condyle::host
