// SPDX-License-Identifier: Apache-2.0
// Smallest detectable changes: against numbers worked out by hand, and how often they are exceeded
// where nothing has changed.
#include "comparison/session_comparison.h"
#include "comparison/repeat_order.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "comparison/block_means.h"
#include "hosted/files/input_error.h"
#include "support/random.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using testing_support::Random;

// Sums of squares about the means 2 and 3: 2 + 2, on 2 + 1 degrees of freedom.
TEST(Repeatability, IsThatWorkedOutByHand) {
  const Repeatability repeats = repeatability({{1, 2, 3}, {2, 4}});
  EXPECT_EQ(repeats.degrees_of_freedom, 3U);
  EXPECT_TRUE(repeats.is_known());
  EXPECT_NEAR(repeats.within_sd, 1.154700538, 1e-9);
  const double t = 3.182446305;  // of the table, 3 degrees of freedom
  EXPECT_NEAR(repeats.smallest_change(1, 1), t * 1.632993162, 1e-6);  // sqrt(2) sqrt(4/3)
  EXPECT_NEAR(repeats.smallest_change(3, 2), t * 1.054092553, 1e-6);  // sqrt(4/3 * 5/6)
  EXPECT_NEAR(repeats.interval.low, std::sqrt(4 / 9.348404), 1e-6);   // chi-square of the table
  EXPECT_NEAR(repeats.interval.high, std::sqrt(4 / 0.2157953), 1e-6);
  // t = 0.948683 on 3 degrees of freedom: 1 - 2/pi (theta + sin theta cos theta),
  // theta = atan(t / sqrt(3))
  EXPECT_NEAR(repeats.probability(1, 3, 2), 0.4127, 1e-4);
  EXPECT_NEAR(repeats.probability(-repeats.smallest_change(3, 2), 3, 2), 0.05, 1e-9);
}

TEST(Repeatability, IsNotKnownWithoutRepeatsThatDiffer) {
  for (const Repeatability& repeats :
       {repeatability({{1}, {2}}), repeatability({{1, 1}, {2, 2}}), repeatability({})}) {
    EXPECT_FALSE(repeats.is_known());
    EXPECT_TRUE(std::isnan(repeats.smallest_change(1, 1)));
    EXPECT_TRUE(std::isnan(repeats.probability(1, 1, 1)));
  }
}

TEST(Holm, IsThatWorkedOutByHand) {
  const double kNan = std::nan("");
  const std::vector<double> adjusted = holm_adjusted({0.04, kNan, 0.01, 0.03, 0.5});
  EXPECT_NEAR(adjusted[2], 0.04, 1e-12);  // 4 * 0.01
  EXPECT_NEAR(adjusted[3], 0.09, 1e-12);  // 3 * 0.03
  EXPECT_NEAR(adjusted[0], 0.09, 1e-12);  // 2 * 0.04, but not below the one before
  EXPECT_NEAR(adjusted[4], 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(adjusted[1]));
}

// 2000 pairs of sessions without change: 100 findings, 9.7 standard deviation; a right one leaves
// four of these with probability 6e-5. With changes of the smallest size half are found and more.
TEST(SmallestChange, IsExceededByChanceOnceInTwenty) {
  Random random(11);
  const auto draw = [&](std::size_t count, double mean) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(mean + 0.3 * random.normal());
    return values;
  };
  for (const auto& [n_1, n_2] : {std::pair<std::size_t, std::size_t>{3, 3}, {2, 5}, {1, 4}}) {
    int false_findings = 0, singles = 0, found = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto before = draw(n_1, 7), after = draw(n_2, 7), third = draw(2, 7);
      const Repeatability repeats = repeatability({before, after});
      const auto mean = [](const std::vector<double>& values) {
        double sum = 0;
        for (const double value : values) sum += value;
        return sum / static_cast<double>(values.size());
      };
      const double smallest = repeats.smallest_change(n_1, n_2);
      const double change = mean(after) - mean(before);
      false_findings += std::abs(change) > smallest ? 1 : 0;
      singles += std::abs(third[0] - third[1]) > repeats.smallest_change(1, 1) ? 1 : 0;
      found += std::abs(change + 1.5 * smallest) > smallest ? 1 : 0;
    }
    EXPECT_NEAR(false_findings, 100, 39) << n_1 << " " << n_2;
    EXPECT_NEAR(singles, 100, 39) << n_1 << " " << n_2;
    EXPECT_GT(found, 1500);
  }
}

// Reports of one estimator with these ranges (mm); what else is compared scatters.
Session session_of(const char* name, const std::vector<double>& ranges_mm, Random& random) {
  Session session{name, {}};
  for (const double range_mm : ranges_mm) {
    RecordingReport report;
    report.source = fmt::format("{}{}", name, session.recordings.size());
    report.step_s = 0.01;
    report.duration_s = 30;
    RunReport run;
    run.range_m = 1e-3 * range_mm;
    run.score = run.error_rms_m = random.normal();
    for (double* const value :
         {&run.velocity_rms_m_s, &run.velocity_peak_up_m_s, &run.velocity_peak_down_m_s,
          &run.noise_sd_m, &run.jerk_density_m2_s5}) {
      *value = 1 + 0.1 * random.normal();
    }
    report.runs.push_back(run);
    session.recordings.push_back(report);
  }
  return session;
}

// Tables of six quantities and three pairs without change: a false finding by Holm in 5 % of 400,
// which is 20; a right one has more than 38 with probability 1e-4.
TEST(SessionComparison, HolmKeepsWholeTablesFromFalseFindings) {
  Random random(5);
  int tables = 0, plain = 0;
  for (int i = 0; i < 400; ++i) {
    std::vector<Session> sessions;
    for (const char* name : {"a", "b", "c"}) {
      sessions.push_back(session_of(
          name, {15 + random.normal(), 15 + random.normal(), 15 + random.normal()}, random));
    }
    const SessionComparison comparison = compare_sessions(sessions);
    EXPECT_LE(comparison.tests(), 18U);
    bool has_false = false;
    for (const QuantityComparison& quantity : comparison.quantities) {
      for (const SessionChange& change : quantity.changes) {
        has_false = has_false || change.exceeds_adjusted();
        plain += change.exceeds() ? 1 : 0;
      }
    }
    tables += has_false ? 1 : 0;
  }
  EXPECT_LE(tables, 38);
  EXPECT_GT(plain, 250);  // 360 expected
}

TEST(SessionComparison, WithholdsWhatIsNotMeasuredInAll) {
  Random random(1);
  std::vector<Session> sessions = {session_of("a", {1, 2}, random),
                                   session_of("b", {3, 4}, random)};
  for (Session& session : sessions) {
    for (RecordingReport& recording : session.recordings) {
      recording.runs[0].mass_kg = {0.25, 0.01, Provenance::assumed};
      recording.runs[0].friction_Ns_m = {0.05, 0.01, Provenance::measured};
    }
  }
  sessions[1].recordings[0].runs[0].friction_Ns_m.provenance = Provenance::assumed;
  RunReport& last = sessions[1].recordings[1].runs[0];
  last.noise_sd_m = last.jerk_density_m2_s5 = EstimateRow::kNone;
  for (const QuantityComparison& quantity : compare_sessions(sessions).quantities) {
    const std::string column = quantity.column;
    const bool is_withheld = column == "mass" || column == "friction" || column == "jerk_density" ||
                             column == "noise_sd";
    EXPECT_EQ(quantity.changes.empty(), is_withheld) << column;
    if (column == "friction") {
      EXPECT_THAT(quantity.withheld, HasSubstr("in 1 of 4 recordings"));
    } else if (column == "mass") {
      EXPECT_THAT(quantity.withheld, HasSubstr("in 4 of 4 recordings"));
    }
  }
}

// Repeats agree to 1 g, sessions differ by 10 g: that may be the drive, if it may be wrong by as
// much in all of a session's recordings alike.
TEST(SessionComparison, AChangeMustExceedWhatTheDriveMayMake) {
  for (const double stated_sd : {0.02, 0.001}) {
    Random random(2);
    std::vector<Session> sessions = {session_of("a", {1, 2, 3}, random),
                                     session_of("b", {1, 2, 3.1}, random)};
    double mass_kg = 0.25;
    for (Session& session : sessions) {
      for (RecordingReport& recording : session.recordings) {
        mass_kg += 0.001;
        recording.runs[0].mass_kg = {mass_kg, stated_sd, Provenance::measured};
      }
      mass_kg += 0.01;
    }
    const QuantityComparison mass = compare_sessions(sessions).quantities.back();
    ASSERT_EQ(mass.column, "mass");
    ASSERT_EQ(mass.changes.size(), 1U);
    EXPECT_NEAR(mass.changes[0].change, 0.013, 1e-12);
    EXPECT_EQ(mass.changes[0].exceeds(), stated_sd < 0.01);
    EXPECT_EQ(std::abs(mass.changes[0].change) > mass.changes[0].smallest, stated_sd < 0.01);
    EXPECT_GE(mass.smallest_single, 1.959 * std::sqrt(2) * stated_sd);
  }
}

const QuantityComparison& quantity_of(const SessionComparison& comparison,
                                      const std::string& column) {
  for (const QuantityComparison& quantity : comparison.quantities) {
    if (quantity.column == column) return quantity;
  }
  throw std::out_of_range(column);
}

TEST(SessionComparison, WithholdsWhatTheConditionsChange) {
  Random random(4);
  const std::vector<Session> alike = {session_of("a", {1, 2, 1.5}, random),
                                      session_of("b", {3, 2, 2.5}, random)};
  auto longer = alike, noisier = alike;
  for (RecordingReport& recording : longer[1].recordings) recording.duration_s *= 1.3;
  for (RecordingReport& recording : noisier[1].recordings) recording.runs[0].noise_sd_m *= 6;
  const auto expect = [](const std::vector<Session>& sessions,
                         const std::vector<std::string>& withheld, const char* words) {
    const SessionComparison comparison = compare_sessions(sessions);
    for (const char* column : {"range", "velocity_rms", "velocity_peak_positive",
                               "velocity_peak_negative", "jerk_density", "noise_sd"}) {
      const bool is_withheld =
          std::find(withheld.begin(), withheld.end(), column) != withheld.end();
      EXPECT_EQ(!quantity_of(comparison, column).withheld.empty(), is_withheld) << column;
      if (is_withheld) {
        EXPECT_THAT(quantity_of(comparison, column).withheld, HasSubstr(words));
      }
    }
  };
  expect(alike, {}, "");
  expect(longer, {"range", "jerk_density"}, "compare recordings of one duration");
  expect(
      noisier,
      {"range", "velocity_rms", "velocity_peak_positive", "velocity_peak_negative", "jerk_density"},
      "compare recordings of one instrument");
}

// By hand: of 0, 1, 2 the orders 0 1 2 and 2 1 0 have the least differences, two of six. Of two
// sessions of independent values 1 % are below 0.01; of 400 more than 13 once in 10^4 times.
TEST(RepeatOrder, IsAsProbableAsItsShareOfOrders) {
  EXPECT_NEAR(probability_of_order({{0, 1, 2}}), 1.0 / 3, 1e-12);
  EXPECT_NEAR(probability_of_order({{0, 2, 1}}), 1, 1e-12);
  EXPECT_NEAR(probability_of_order({{0, 1, 2}, {5, 4, 3}}), 1.0 / 9, 1e-12);
  EXPECT_EQ(probability_of_order({{1}, {2, 3}}), 1);
  Random random(6);
  const auto share_found = [&random](double correlation) {
    int found = 0;
    for (int i = 0; i < 400; ++i) {
      std::vector<std::vector<double>> sessions(2);
      for (auto& values : sessions) {
        double x = random.normal();
        for (int j = 0; j < 6; ++j) {
          values.push_back(x);
          x = correlation * x + std::sqrt(1 - correlation * correlation) * random.normal();
        }
      }
      found += probability_of_order(sessions) < 0.01 ? 1 : 0;
    }
    return found;
  };
  EXPECT_LE(share_found(0), 13);
  EXPECT_GE(share_found(0.8), 60);
}

TEST(SessionComparison, RefusesCopiesAndOtherRates) {
  Random random(3);
  const std::vector<Session> good = {session_of("a", {1, 2}, random),
                                     session_of("b", {3, 4}, random)};
  const auto refuse = [](const std::vector<Session>& sessions, const char* words) {
    try {
      (void)compare_sessions(sessions);
      ADD_FAILURE() << words;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  };
  EXPECT_NO_THROW((void)compare_sessions(good));
  auto copied = good;
  copied[1].recordings[0].runs = copied[0].recordings[1].runs;
  refuse(copied, "b0: is a copy of a1");
  auto faster = good;
  faster[1].recordings[1].step_s = 0.005;
  refuse(faster, "b1: has 200 samples a second, a0 has 100");
  auto other = good;
  other[1].recordings[1].kind = SampleKind::three_points;
  refuse(other, "compare recordings of one kind");
}

// 1000 series without difference, each number like the one before (time constant 20, blocks of
// 120): 5 % of the intervals leave out zero, fewer because the widest counts; 79 and more happen
// with probability 1e-4 at 5 %. Blocks of one number would do it far more often.
TEST(BlockMeans, AreNotFooledByNeighboursThatAgree) {
  Random random(8);
  int false_findings = 0, found = 0;
  for (int i = 0; i < 1000; ++i) {
    BlockMeans means(120), shifted(120);
    double value = 0;
    for (int k = 0; k < 2400; ++k) {
      value = 0.95 * value + random.normal();
      means.add(value);
      shifted.add(value + 2);  // 4.9 standard deviations of the mean
    }
    const BlockMean report = means.report(0.95);
    EXPECT_GE(report.blocks, BlockMeans::kFewestBlocks);
    false_findings += report.differs_from_zero() ? 1 : 0;
    found += shifted.report(0.95).differs_from_zero() ? 1 : 0;
  }
  EXPECT_LT(false_findings, 79);
  EXPECT_GT(false_findings, 5);
  EXPECT_GT(found, 950);
}

TEST(BlockMeans, JoinBlocksAndSayWhenThereAreTooFew) {
  BlockMeans few(10), none(0), many(1);
  for (int i = 0; i < 79; ++i) few.add(i);
  EXPECT_EQ(few.report(0.95).blocks, 0U);
  EXPECT_FALSE(few.report(0.95).differs_from_zero());
  EXPECT_NEAR(few.report(0.95).mean, 39, 1e-12);
  few.add(79);
  EXPECT_EQ(few.report(0.95).blocks, 8U);
  for (int i = 0; i < 10'000; ++i) {
    none.add(1);
    many.add(i % 2 == 0 ? 1 : 3);
  }
  EXPECT_EQ(none.report(0.95).blocks, 0U);
  // Two of a pair are one block by now: they do not differ.
  EXPECT_EQ(many.report(0.95).standard_error, 0);
  EXPECT_TRUE(many.report(0.95).differs_from_zero());
  EXPECT_EQ(many.count(), 10'000U);
}

}  // namespace
}  // namespace condyle::host
