// SPDX-License-Identifier: Apache-2.0
// The accumulators against the definitions, on numbers written down.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "evaluation/consistency.h"
#include "evaluation/error_statistics.h"
#include "evaluation/response_slope.h"
#include "support/random.h"

namespace condyle::host {
namespace {

using testing_support::Random;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(ErrorStatistics, NominalIntervalsAreNormal) {
  EXPECT_NEAR(normal_quantile((1 + kNominalCoverage) / 2), kNormalQuantile95, 1e-14);
}

TEST(ErrorStatistics, OneSampleARunIsTheTextbook) {
  const double errors[] = {1, -2, 4, 0.5, -0.5};
  ErrorStatistics statistics;
  for (const double error : errors) {
    RunErrors run;
    run.add(error, 1);
    statistics.add_run(run);
  }
  const ErrorReport report = statistics.report(0.95);
  EXPECT_EQ(report.runs, 5U);
  EXPECT_EQ(report.samples, 5U);
  EXPECT_NEAR(report.rms, std::sqrt(21.5 / 5), 1e-15);
  EXPECT_NEAR(report.bias, 0.6, 1e-15);
  EXPECT_NEAR(report.bias_standard_error, std::sqrt((21.5 - 5 * 0.36) / 4 / 5), 1e-15);
  EXPECT_NEAR(report.coverage, 0.6, 1e-15);
  const Interval expected = proportion_interval(3, 5, 0.95);
  EXPECT_NEAR(report.coverage_interval.low, expected.low, 1e-12);
  EXPECT_NEAR(report.coverage_interval.high, expected.high, 1e-12);
  EXPECT_NEAR(report.mean_normalised_square, 4.3, 1e-15);
  EXPECT_NEAR(report.normalised_square_bounds.high, chi_square_quantile(0.975, 5) / 5, 1e-12);
  EXPECT_FALSE(report.normalised_square_is_inside);  // above 2.57
}

// A run whose samples repeat one error a thousand times is one sample.
TEST(ErrorStatistics, RepeatedSamplesAddNoCertainty) {
  Random random(3);
  ErrorStatistics once, repeated;
  for (int i = 0; i < 200; ++i) {
    const double error = random.normal();
    RunErrors one, many;
    one.add(error, 1);
    for (int k = 0; k < 1000; ++k) many.add(error, 1);
    once.add_run(one);
    repeated.add_run(many);
  }
  const ErrorReport a = once.report(0.95), b = repeated.report(0.95);
  EXPECT_NEAR(a.bias_standard_error, b.bias_standard_error, 1e-12);
  EXPECT_NEAR(a.rms_standard_error, b.rms_standard_error, 1e-12);
  EXPECT_NEAR(a.coverage_interval.low, b.coverage_interval.low, 2e-3);
  EXPECT_NEAR(a.coverage_interval.high, b.coverage_interval.high, 2e-3);
  EXPECT_EQ(b.samples, 200000U);
}

TEST(ErrorStatistics, WhatIsNoNumberIsCountedAndNotCovered) {
  RunErrors run;
  run.add(0.1, 1);
  run.add(kNan, 1);
  run.add(0.1, kNan);
  run.add(0.1, 0);
  run.add(0.1, -1);
  run.add(0.1, HUGE_VAL);
  run.add(HUGE_VAL, HUGE_VAL, true);
  ErrorStatistics statistics;
  statistics.add_run(run);
  const ErrorReport report = statistics.report(0.95);
  EXPECT_EQ(report.samples, 7U);
  EXPECT_EQ(report.unusable, 6U);
  EXPECT_NEAR(report.coverage, 1.0 / 7, 1e-15);
  EXPECT_NEAR(report.rms, 0.1, 1e-15);
  EXPECT_FALSE(report.normalised_square_is_inside);
}

TEST(ErrorStatistics, NothingSaysNothing) {
  ErrorStatistics statistics;
  statistics.add_run(RunErrors());
  const ErrorReport report = statistics.report(0.95);
  EXPECT_EQ(report.runs, 0U);
  EXPECT_TRUE(std::isnan(report.rms));
  EXPECT_EQ(report.coverage_interval.low, 0);
  EXPECT_EQ(report.coverage_interval.high, 1);
  EXPECT_FALSE(report.normalised_square_is_inside);
}

TEST(ErrorStatistics, MergedPartsAreTheWhole) {
  Random random(4);
  ErrorStatistics whole, parts[2];
  for (int i = 0; i < 50; ++i) {
    RunErrors run;
    for (int k = 0; k <= i % 7; ++k) run.add(1e6 + random.normal(), 1);
    whole.add_run(run);
    parts[i < 20 ? 0 : 1].add_run(run);
  }
  parts[0].merge(parts[1]);
  const ErrorReport a = whole.report(0.95), b = parts[0].report(0.95);
  EXPECT_NEAR(a.bias, b.bias, 1e-9);
  EXPECT_NEAR(a.bias_standard_error, b.bias_standard_error, 1e-9);
  EXPECT_NEAR(a.rms, b.rms, 1e-9);
  EXPECT_EQ(a.samples, b.samples);
}

TEST(Consistency, NormalisedSquareIsThatOfTheInverse) {
  const Eigen::Vector2d error(1, 2);
  const Eigen::Matrix2d P{{4, 1}, {1, 2}};
  EXPECT_NEAR(normalised_square<2>(error, P), 2, 1e-15);  // (2 - 4 + 16) / 7
  EXPECT_TRUE(std::isnan(normalised_square<2>(error, -P)));
  EXPECT_TRUE(std::isnan(normalised_square<2>(error, kNan * P)));
  EXPECT_TRUE(std::isnan(normalised_square<2>({kNan, 0}, P)));
}

TEST(Consistency, AnUnusableTermIsNeverInside) {
  RunSquares run;
  for (int i = 0; i < 100; ++i) run.add(1);
  ConsistencyStatistics statistics(1, ConsistencyStatistics::Independent::terms);
  statistics.add_run(run);
  EXPECT_TRUE(statistics.report(0.95).inside);
  run.add(kNan);
  statistics.add_run(run);
  const ConsistencyReport report = statistics.report(0.95);
  EXPECT_FALSE(report.inside);
  EXPECT_EQ(report.terms, 201U);
  EXPECT_EQ(report.unusable, 1U);
  EXPECT_EQ(report.mean, 1);
}

TEST(ResponseSlope, IsOneForIdentityAndZeroForAConstant) {
  ResponseSlope identity, constant;
  for (const double truth : {0.0, 0.022, 0.088, 0.5, 2.0}) {
    identity.add(truth, truth);
    constant.add(truth, 0.068);
  }
  EXPECT_NEAR(identity.report(0.95).slope, 1, 1e-15);
  EXPECT_NEAR(identity.report(0.95).intercept, 0, 1e-15);
  EXPECT_NEAR(identity.report(0.95).slope_standard_error, 0, 1e-7);
  EXPECT_EQ(constant.report(0.95).slope, 0);
  EXPECT_EQ(constant.report(0.95).slope_standard_error, 0);
  EXPECT_EQ(constant.report(0.95).intercept, 0.068);
}

// The first of Anscombe's quartets (1973): y = 3.00 + 0.500 x, standard error 0.118.
TEST(ResponseSlope, FitsThePublishedExample) {
  const double x[] = {10, 8, 13, 9, 11, 14, 6, 4, 12, 7, 5};
  const double y[] = {8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68};
  ResponseSlope line, later;
  for (std::size_t i = 0; i < 11; ++i) (i < 4 ? line : later).add(x[i], y[i]);
  line.merge(later);
  const SlopeReport report = line.report(0.95);
  EXPECT_NEAR(report.slope, 0.5001, 5e-5);
  EXPECT_NEAR(report.intercept, 3.0001, 5e-5);
  EXPECT_NEAR(report.slope_standard_error, 0.1179, 5e-5);
  EXPECT_NEAR(report.slope_interval.high - report.slope, 2.262 * 0.1179, 5e-4);
}

TEST(ResponseSlope, SaysWhereThereIsNone) {
  ResponseSlope same_truth;
  same_truth.add(1, 2);
  same_truth.add(1, 3);
  same_truth.add(kNan, 3);
  const SlopeReport report = same_truth.report(0.95);
  EXPECT_TRUE(std::isnan(report.slope));
  EXPECT_EQ(report.pairs, 2U);
  EXPECT_EQ(report.unusable, 1U);
}

}  // namespace
}  // namespace condyle::host
