// SPDX-License-Identifier: Apache-2.0
// What is said of one estimator on one recording.
#include "comparison/run_statistics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "comparison/compared_recording.h"
#include "comparison/comparison_text.h"
#include "comparison/figure_label.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "support/random.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;

// A row of one axis whose innovation is predicted with `sd_m`.
EstimateRow predicted_row(double innovation_m, double sd_m, double velocity_m_s) {
  EstimateRow row;
  row.axis_count = 1;
  row.innovation_m = row.axes[0].innovation_m = innovation_m;
  row.axes[0].innovation_sd_m = sd_m;
  row.motion_nis = innovation_m * innovation_m / (sd_m * sd_m);
  row.position_m = {0.01 * velocity_m_s, 1e-5, Provenance::measured};
  row.velocity_m_s = {velocity_m_s, 1e-3, Provenance::measured};
  row.axes[0].noise_sd_m = 1e-4;
  row.axes[0].jerk_density_m2_s5 = 2;
  return row;
}

TEST(RunStatistics, AreThoseWorkedOutByHand) {
  RunStatistics statistics(0, Axis::z, true);
  for (int i = 1; i <= 100; ++i) {
    const double sign = i % 2 == 0 ? 1 : -1;
    const EstimateRow row = predicted_row(sign * 2e-4, 1e-4, sign * 1e-3 * i);
    EstimateRow first = row;
    first.velocity_m_s.value += 3e-3;
    statistics.add(row, first, 0.01, true);
  }
  EstimateRow assumed = predicted_row(0, 1e-4, 100);  // counts for nothing that is measured
  assumed.position_m.provenance = assumed.velocity_m_s.provenance = Provenance::derived;
  assumed.innovation_m = assumed.axes[0].innovation_m = EstimateRow::kNone;
  assumed.events.add(Event::position_missing);
  EXPECT_FALSE(statistics.has_prediction(assumed));
  statistics.add(assumed, assumed, 0.01, false);

  const RunReport report = statistics.report();
  EXPECT_EQ(report.missing, 1U);
  EXPECT_EQ(report.rejected, 0U);
  EXPECT_NEAR(report.measured_share, 100 / 101.0, 1e-12);
  EXPECT_NEAR(report.error_rms_m, 2e-4, 1e-12);
  EXPECT_NEAR(report.error_median_m, 2e-4, 1e-12);
  EXPECT_NEAR(report.mean_nis, 4, 1e-9);
  EXPECT_EQ(report.nis_samples, 100U);
  EXPECT_FALSE(report.nis_bounds.contains(report.mean_nis));
  EXPECT_NEAR(report.correlation, -1, 0.02);
  EXPECT_FALSE(report.is_whiteness_judged);
  // N(0.2; 0, 0.1 mm) = 0.539910 a mm
  EXPECT_NEAR(report.score, std::log(0.999 * 0.5399096651 + 1e-5), 1e-9);
  EXPECT_EQ(report.score_difference.mean, 0);
  EXPECT_EQ(report.score_difference.blocks, 0U);
  EXPECT_NEAR(report.range_m, 1.99e-3, 1e-12);
  EXPECT_NEAR(report.velocity_rms_m_s, 1e-3 * std::sqrt(101 * 201 / 6.0), 1e-9);
  EXPECT_NEAR(report.velocity_peak_up_m_s, 0.100, 1e-12);  // of 2, 4 ... 100 mm/s
  EXPECT_NEAR(report.velocity_peak_down_m_s, 0.099, 1e-12);
  EXPECT_NEAR(report.velocity_difference_m_s, 3e-3, 1e-12);
  EXPECT_NEAR(report.noise_sd_m, 1e-4, 1e-12);
  EXPECT_NEAR(report.jerk_density_m2_s5, 2, 1e-12);
}

TEST(RunStatistics, NoiseAtItsLimitIsNotKnown) {
  RunStatistics statistics(0, Axis::z, true), given(0, Axis::z, false);
  for (int i = 0; i < 100; ++i) {
    EstimateRow row = predicted_row(1e-4, 1e-4, 0.01);
    row.events.add(Event::noise_at_limit, i < 51);
    statistics.add(row, row, 0.01, true);
    given.add(row, row, 0.01, true);
  }
  EXPECT_TRUE(std::isnan(statistics.report().noise_sd_m));
  EXPECT_TRUE(std::isnan(statistics.report().jerk_density_m2_s5));
  EXPECT_TRUE(std::isnan(given.report().noise_sd_m));
}

TEST(RunStatistics, NoiseThatIsNotWhiteIsNotKnown) {
  testing_support::Random random(6);
  for (const double persistence : {0.0, 0.5}) {
    RunStatistics statistics(0, Axis::z, true);
    double error_m = 0;
    for (int i = 0; i < 2000; ++i) {
      error_m = persistence * error_m + 1e-4 * random.normal();
      const EstimateRow row = predicted_row(error_m, 1e-4, 0.01);
      statistics.add(row, row, 0.01, true);
    }
    const RunReport report = statistics.report();
    EXPECT_TRUE(report.is_whiteness_judged);
    EXPECT_EQ(report.is_correlated, persistence > 0);
    EXPECT_EQ(std::isnan(report.noise_sd_m), persistence > 0);
    EXPECT_NEAR(report.correlation, persistence, 0.09);
  }
}

// Nobody gains by stating another standard deviation than the errors have, and a glitch costs at
// most what ln(N(0) / (0.001 / 100 mm)) is: 12.9 here.
TEST(RunStatistics, TheScoreIsBestForTheTruthAndBoundedForGlitches) {
  const auto score = [](double stated_sd_m, double glitch_m) {
    testing_support::Random random(4);
    RunStatistics statistics(100, Axis::z, true);
    for (int i = 0; i < 4000; ++i) {
      const double error_m = i == 2000 ? glitch_m : 1e-4 * random.normal();
      const EstimateRow row = predicted_row(error_m, stated_sd_m, 0.01);
      const EstimateRow first = predicted_row(error_m, 1e-4, 0.01);
      statistics.add(row, first, 0.01, true);
    }
    return statistics.report();
  };
  for (const double stated_sd_m : {0.7e-4, 1.4e-4}) {
    const BlockMean difference = score(stated_sd_m, 0).score_difference;
    EXPECT_TRUE(difference.differs_from_zero());
    EXPECT_LT(difference.mean, -0.05);
  }
  const double cost = 4000 * (score(1e-4, 0).score - score(1e-4, 0.05).score);
  EXPECT_GT(cost, 10);
  EXPECT_LT(cost, 13);
}

TEST(RunStatistics, WithoutARowNothingIsKnown) {
  const RunReport report = RunStatistics(0, Axis::z, true).report();
  for (const double value :
       {report.error_rms_m, report.error_median_m, report.score, report.mean_nis, report.range_m,
        report.correlation, report.velocity_rms_m_s, report.velocity_peak_up_m_s,
        report.velocity_difference_m_s, report.noise_sd_m, report.jerk_density_m2_s5}) {
    EXPECT_TRUE(std::isnan(value));
  }
  EXPECT_EQ(report.friction_Ns_m.provenance, Provenance::not_computed);
}

TEST(QuantileHistogram, FindsQuantiles) {
  QuantileHistogram histogram;
  EXPECT_TRUE(std::isnan(histogram.quantile(0.5)));
  for (int i = 1; i <= 1000; ++i) histogram.add(1e-3 * i);
  EXPECT_NEAR(histogram.quantile(0), 1e-3, 1e-12);
  EXPECT_NEAR(histogram.quantile(0.5), 0.5, 0.001);
  EXPECT_NEAR(histogram.quantile(0.99), 0.99, 0.002);
  EXPECT_NEAR(histogram.quantile(1), 1, 0.002);
  histogram.add(0);
  histogram.add(1e9);
  EXPECT_EQ(histogram.quantile(0), 0);
  EXPECT_EQ(histogram.quantile(1), 1e9);
}

TEST(Comparison, NamesOfEstimators) {
  const NamedEstimator tuned = parse_estimator("recommended:a:b.toml", 3);
  EXPECT_EQ(tuned.option.parameters, "a:b.toml");
  EXPECT_EQ(tuned.option.lag, 3);
  EXPECT_TRUE(parse_estimator("published", 3).option.is_published());
  EXPECT_EQ(parse_estimator("published", 3).option.lag, 0);
  for (const char* wrong : {"", "kalman", "recommended:", "Published", ":x.toml"}) {
    EXPECT_THROW((void)parse_estimator(wrong, 0), InputError) << wrong;
  }
}

TEST(Comparison, LabelsAndFields) {
  EXPECT_EQ(figure_label("short.csv", 9), "short.csv");
  EXPECT_EQ(figure_label("abcdefghijklmnop", 9), "abc...nop");
  EXPECT_EQ(figure_label("ääääääääääää", 9), "äää...äää");
  EXPECT_EQ(figure_label("ääää", 4), "ääää");
  EXPECT_EQ(csv_field("a b.csv"), "a b.csv");
  EXPECT_EQ(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
}

}  // namespace
}  // namespace condyle::host
