// SPDX-License-Identifier: Apache-2.0
#include "estimation/resampled_rows.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/rapidcheck_gtest.h"

namespace condyle::host {
namespace {

using testing_support::number_between;

constexpr double kNoise_m = 1e-4;

// A motion of degree 3 in time, which the interpolation must reproduce.
struct Motion {
  double p, v, a, j;
  double position_m(double t) const { return p + t * (v + t * (a / 2 + t * j / 6)); }
  double velocity_m_s(double t) const { return v + t * (a + t * j / 2); }
  double acceleration_m_s2(double t) const { return a + t * j; }
};

EstimateRow row_at(TimeNs time_ns, const Motion& motion, double density = 0) {
  const double t = seconds(time_ns);
  EstimateRow row;
  row.time_ns = time_ns;
  row.axis_count = 1;
  AxisEstimate<double>& axis = row.followed;
  axis.position_m = {motion.position_m(t), kNoise_m, Provenance::measured};
  axis.velocity_m_s = {motion.velocity_m_s(t), 1e-2, Provenance::measured};
  axis.acceleration_m_s2 = {motion.acceleration_m_s2(t), 1, Provenance::measured};
  axis.force_N = {0.25 * motion.acceleration_m_s2(t), 0.25, Provenance::derived};
  axis.jerk_density_m2_s5 = density;
  axis.measured_position_m = motion.position_m(t);
  row.axes[0] = axis;
  row.position_m = axis.position_m;
  row.velocity_m_s = axis.velocity_m_s;
  row.force_N = axis.force_N;
  row.measured_position_m = axis.measured_position_m;
  return row;
}

std::vector<EstimateRow> resampled(const std::vector<EstimateRow>& rows, double rate_Hz) {
  std::vector<EstimateRow> result;
  ResampledRows resampler(rate_Hz);
  for (const EstimateRow& row : rows) {
    resampler.add(row, [&](const EstimateRow& instant) { result.push_back(instant); });
  }
  return result;
}

RC_GTEST_PROP(ResampledRows, FollowAMotionAtUnevenSteps, ()) {
  const Motion motion{*number_between(-0.05, 0.05), *number_between(-0.3, 0.3),
                      *number_between(-3, 3), *number_between(-30, 30)};
  const double rate_Hz = *number_between(0.5, 2000);
  std::vector<EstimateRow> rows;
  TimeNs time_ns = *rc::gen::inRange<TimeNs>(-1'000'000'000, 1'000'000'000);
  const TimeNs begin_ns = time_ns;
  for (int i = 0; i < 30; ++i) {
    rows.push_back(row_at(time_ns, motion));
    time_ns += *rc::gen::inRange<TimeNs>(1'000'000, 40'000'000);
  }
  const auto instants = resampled(rows, rate_Hz);
  const TimeNs end_ns = *rows.back().time_ns;
  // The grid is complete, from the first sample to the last.
  RC_ASSERT(instants.size() ==
            static_cast<std::size_t>(std::floor(seconds(end_ns - begin_ns) * rate_Hz + 1e-9)) + 1);
  for (std::size_t k = 0; k < instants.size(); ++k) {
    const EstimateRow& instant = instants[k];
    RC_ASSERT(*instant.time_ns == begin_ns + std::llround(static_cast<double>(k) * 1e9 / rate_Hz));
    const double t = seconds(*instant.time_ns);
    RC_ASSERT(std::abs(instant.position_m.value - motion.position_m(t)) < 1e-12);
    RC_ASSERT(std::abs(instant.velocity_m_s.value - motion.velocity_m_s(t)) < 1e-10);
    RC_ASSERT(std::abs(instant.followed.acceleration_m_s2.value - motion.acceleration_m_s2(t)) <
              1e-8);
    RC_ASSERT(std::abs(instant.force_N.value - 0.25 * motion.acceleration_m_s2(t)) < 1e-8);
    RC_ASSERT(instant.position_m.standard_deviation >= kNoise_m);
    const bool is_sample = std::any_of(rows.begin(), rows.end(), [&](const EstimateRow& row) {
      return row.time_ns == instant.time_ns;
    });
    RC_ASSERT((instant.position_m.provenance == Provenance::measured) == is_sample);
    RC_ASSERT(std::isfinite(instant.measured_position_m) == is_sample);
  }
}

// Variance of the bridge of integrated noise in the middle of a step: 1/4, 1/192 and 1/20480.
TEST(ResampledRows, WidenTheIntervalBetweenSamples) {
  constexpr double kDensity = 5, kStep_s = 0.02;
  const Motion still{};
  const auto instants =
      resampled({row_at(0, still, kDensity), row_at(20'000'000, still, kDensity)}, 100);
  ASSERT_EQ(instants.size(), 3U);
  const AxisEstimate<double>& middle = instants[1].followed;
  const auto expected = [&](double noise, double variance) {
    return std::hypot(noise, std::sqrt(variance));
  };
  EXPECT_NEAR(middle.acceleration_m_s2.standard_deviation, expected(1, kDensity * kStep_s / 4),
              1e-12);
  EXPECT_NEAR(middle.velocity_m_s.standard_deviation,
              expected(1e-2, kDensity * std::pow(kStep_s, 3) / 192), 1e-14);
  EXPECT_NEAR(middle.position_m.standard_deviation,
              expected(kNoise_m, kDensity * std::pow(kStep_s, 5) / 20480), 1e-16);
  EXPECT_NEAR(middle.force_N.standard_deviation, 0.25 * middle.acceleration_m_s2.standard_deviation,
              1e-12);
  EXPECT_EQ(instants[2].followed.position_m.standard_deviation, kNoise_m);
}

TEST(ResampledRows, LeaveGapsAndLoseNoEvent) {
  const Motion motion{0.01, 0.1, 0, 0};
  std::vector<EstimateRow> rows;
  for (const TimeNs time_ms : {0, 10, 20, 520, 530, 540}) {
    rows.push_back(row_at(time_ms * 1'000'000, motion));
  }
  rows[1].events.add(Event::outlier_weighted);
  rows[3].events.add(Event::time_gap);
  EstimateRow repeated = rows[4];
  repeated.events.add(Event::time_repeated);
  rows.insert(rows.begin() + 5, repeated);
  const auto instants = resampled(rows, 50);
  std::vector<TimeNs> times_ms;
  EventCounts counts;
  for (const EstimateRow& instant : instants) {
    times_ms.push_back(*instant.time_ns / 1'000'000);
    counts.add(instant.events);
  }
  EXPECT_EQ(times_ms, (std::vector<TimeNs>{0, 20, 520, 540}));
  for (const Event event : {Event::outlier_weighted, Event::time_gap, Event::time_repeated}) {
    EXPECT_EQ(counts[event], 1U) << event_name(event);
  }
}

TEST(ResampledRows, BeginAnewWhenTheClockDoes) {
  const Motion motion{0.01, 0.1, 0, 0};
  std::vector<EstimateRow> rows = {row_at(1'000'000'000, motion), row_at(1'010'000'000, motion),
                                   row_at(3'000'000, motion), row_at(13'000'000, motion)};
  rows[2].events.add(Event::time_restarted);
  const auto instants = resampled(rows, 100);
  ASSERT_EQ(instants.size(), 4U);
  EXPECT_EQ(*instants[2].time_ns, 3'000'000);
  EXPECT_EQ(*instants[3].time_ns, 13'000'000);
}

// Nothing becomes known that was not.
TEST(ResampledRows, KeepWhatIsNotComputedEmpty) {
  const Motion motion{0.01, 0.1, 0, 0};
  std::vector<EstimateRow> rows = {row_at(0, motion), row_at(20'000'000, motion)};
  rows[1].followed.velocity_m_s = rows[1].velocity_m_s = {};
  rows[1].followed.acceleration_m_s2.provenance = Provenance::assumed;
  const auto instants = resampled(rows, 100);
  ASSERT_EQ(instants.size(), 3U);
  EXPECT_EQ(instants[1].velocity_m_s.provenance, Provenance::not_computed);
  EXPECT_TRUE(std::isnan(instants[1].velocity_m_s.value));
  EXPECT_EQ(instants[1].followed.acceleration_m_s2.provenance, Provenance::assumed);
}

}  // namespace
}  // namespace condyle::host
