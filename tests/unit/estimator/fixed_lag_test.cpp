// SPDX-License-Identifier: Apache-2.0
// Estimates of some samples ago against the Rauch-Tung-Striebel smoother, and their order.
#include "condyle/estimator/motion/fixed_lag.h"

#include "condyle/estimator/motion/recommended_estimator.h"
#include "unit/estimator/axis_samples.h"

namespace condyle {
namespace {

using testing_support::AxisSample;
using testing_support::DenseTwin;
using testing_support::Far;
using testing_support::troubled_samples;

MotionEstimatorParameters known_noise() {
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  return parameters;
}

TimedPosition<double, 1> measurement(const AxisSample& sample) {
  return {sample.time_ns, sample.is_measured, {sample.position_m}, {}};
}

void expect_is(const RecommendedEstimate<double>& estimate, const DenseTwin& twin,
               std::size_t index, double tolerance) {
  const auto expected = twin.estimate(index);
  const auto& axis = estimate.axes[0];
  const Quantity<double>* quantities[] = {&axis.position_m, &axis.velocity_m_s,
                                          &axis.acceleration_m_s2};
  for (int i = 0; i < 3; ++i) {
    const auto& quantity = *quantities[i];
    RC_ASSERT(std::isfinite(quantity.value) == expected.has_value());
    if (!expected) continue;
    const double sd = std::sqrt(static_cast<double>(expected->P(i, i)));
    RC_ASSERT(std::abs(quantity.value - static_cast<double>(expected->x[i])) <= tolerance * sd);
    RC_ASSERT(std::abs(quantity.standard_deviation - sd) <= tolerance * sd);
  }
}

bool revokes(const MotionEstimatorParameters& parameters, const std::vector<AxisSample>& samples) {
  RecommendedEstimator<double, 1> estimator(parameters);
  bool does = false;
  for (const AxisSample& sample : samples) {
    does |= estimator.step(measurement(sample)).events.has(Event::outlier_revoked);
  }
  return does;
}

// Every estimate, those of the samples after the last included.
RC_GTEST_PROP(FixedLag, IsTheFixedIntervalSmootherOverItsWindow, ()) {
  MotionEstimatorParameters parameters = known_noise();
  parameters.outliers.gate_sd = 1000;  // what is beyond the gate: below
  const int lag = *rc::gen::inRange(0, 17);
  const auto samples = *troubled_samples(parameters.noise.position_sd_m, Far::left_out);
  RC_PRE(!revokes(parameters, samples));  // the twin does not
  RecommendedEstimator<double, 1> estimator(parameters, lag);
  DenseTwin twin(parameters);
  std::size_t next = 0;
  for (const AxisSample& sample : samples) {
    const auto estimate = estimator.step(measurement(sample));
    twin.step(sample);
    if (estimate.is_ready) expect_is(estimate, twin, next++, 1e-6);
  }
  RecommendedEstimate<double> estimate;
  while (estimator.drain(estimate)) expect_is(estimate, twin, next++, 1e-6);
  RC_ASSERT(next == samples.size());
  RC_CLASSIFY(twin.restarts() > 0, "with restarts");
  RC_CLASSIFY(twin.weighted() > 0, "with outliers that count less");
}

constexpr TimeNs kStep_ns = 10'000'000;

double swing_m(TimeNs i) {
  return 0.005 * std::sin(0.08 * static_cast<double>(i)) +
         5e-5 * static_cast<double>(i * 7919 % 31 - 15) / 9;
}

// Estimates of `count` samples of a swing, each `lag` samples late. Sample `bad` is displaced by
// `offset_m`, or missing.
std::vector<RecommendedEstimate<double>> late_swing(TimeNs count, int lag, TimeNs bad,
                                                    double offset_m, bool is_missing) {
  RecommendedEstimator<double, 1> estimator({}, lag);
  std::vector<RecommendedEstimate<double>> estimates;
  for (TimeNs i = 0; i < count; ++i) {
    const bool is_bad = i == bad;
    const auto estimate = estimator.step(
        {i * kStep_ns, !(is_bad && is_missing), {swing_m(i) + (is_bad ? offset_m : 0)}, {}});
    if (estimate.is_ready) estimates.push_back(estimate);
  }
  RecommendedEstimate<double> estimate;
  while (estimator.drain(estimate)) estimates.push_back(estimate);
  return estimates;
}

// Once later samples have shown a glitch to be one, all that is still to be said is as if it were
// missing, bit for bit.
TEST(FixedLag, AGlitchFoundOutIsAsIfItWereMissing) {
  for (const double offset_m : {0.001, -0.004, 0.02, 0.5}) {
    for (const int lag : {1, 3, 10}) {
      const auto with = late_swing(160, lag, 120, offset_m, false);
      const auto without = late_swing(160, lag, 120, 0, true);
      ASSERT_TRUE(with[120].events.has(Event::outlier_rejected)) << offset_m;
      for (std::size_t i = 0; i < with.size(); ++i) {
        if (static_cast<int>(i) + lag == 120) continue;  // said when it came, in doubt
        const auto &one = with[i].axes[0], &other = without[i].axes[0];
        ASSERT_EQ(one.position_m.value, other.position_m.value)
            << offset_m << " " << lag << ' ' << i;
        ASSERT_EQ(one.velocity_m_s.value, other.velocity_m_s.value) << offset_m << " " << i;
        ASSERT_EQ(one.velocity_m_s.standard_deviation, other.velocity_m_s.standard_deviation);
      }
    }
  }
}

// A step of what is followed: what is said of its first samples, late enough for both hypotheses to
// have been compared, is of the new place, and no worse known than elsewhere.
TEST(FixedLag, AChangeOfTheMotionIsFollowedFromItsFirstSample) {
  for (const double step_m : {0.002, 0.05}) {
    RecommendedEstimator<double, 1> estimator({}, 10);
    for (TimeNs i = 0; i < 170; ++i) {
      const auto estimate =
          estimator.step({i * kStep_ns, true, {swing_m(i) + (i < 120 ? 0 : step_m)}, {}});
      if (!estimate.is_ready || estimate.time_ns < 100 * kStep_ns) continue;
      const TimeNs at = estimate.time_ns / kStep_ns;
      const double truth_m =
          0.005 * std::sin(0.08 * static_cast<double>(at)) + (at < 120 ? 0 : step_m);
      const auto& position = estimate.axes[0].position_m;
      EXPECT_LE(std::abs(position.value - truth_m), 4 * position.standard_deviation) << at;
      EXPECT_LE(position.standard_deviation, 1e-4) << at;
    }
  }
}

// After a restart the old motion is estimated as if nothing had followed it.
TEST(FixedLag, EvidenceDoesNotCrossARestart) {
  RecommendedEstimator<double, 1> late(known_noise(), 10), ended(known_noise(), 10);
  std::vector<RecommendedEstimate<double>> from_late, from_ended;
  RecommendedEstimate<double> drained;
  for (TimeNs i = 0; i < 60; ++i) {
    const AxisSample sample{i * 10'000'000 + (i < 30 ? 0 : 1'000'000'000), true,
                            i < 30 ? 0.001 * static_cast<double>(i) : -0.05};
    const auto estimate = late.step(measurement(sample));
    if (estimate.is_ready) from_late.push_back(estimate);
    if (i >= 30) continue;
    const auto early = ended.step(measurement(sample));
    if (early.is_ready) from_ended.push_back(early);
  }
  while (ended.drain(drained)) from_ended.push_back(drained);
  ASSERT_EQ(from_ended.size(), 30U);
  for (std::size_t i = 0; i < 30; ++i) {
    const auto &one = from_late[i].axes[0], &other = from_ended[i].axes[0];
    EXPECT_EQ(one.velocity_m_s.value, other.velocity_m_s.value) << i;
    EXPECT_EQ(one.velocity_m_s.standard_deviation, other.velocity_m_s.standard_deviation) << i;
  }
}

// Rows are samples: each once, in order, with its own time, events and measurement.
RC_GTEST_PROP(FixedLag, EstimatesAreTheSamplesInOrder, ()) {
  const int lag = *rc::gen::inRange(0, 17);
  const auto samples = *troubled_samples(1e-4, Far::drawn);
  const bool adapts = *rc::gen::arbitrary<bool>();
  RecommendedEstimator<double, 1> estimator(adapts ? MotionEstimatorParameters{} : known_noise(),
                                            lag),
      prompt(adapts ? MotionEstimatorParameters{} : known_noise());
  std::vector<RecommendedEstimate<double>> rows, prompt_rows;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    auto sample = measurement(samples[i]);
    sample.events.add(Event::zero_filled, i % 7 == 3);
    const bool skipped = i % 11 == 5;
    const auto estimate = skipped ? estimator.skip(sample, i % 2 == 0) : estimator.step(sample);
    RC_ASSERT(estimate.is_ready == (i >= static_cast<std::size_t>(lag)));
    if (estimate.is_ready) rows.push_back(estimate);
    prompt_rows.push_back(skipped ? prompt.skip(sample, i % 2 == 0) : prompt.step(sample));
  }
  RecommendedEstimate<double> estimate;
  while (estimator.drain(estimate)) {
    RC_ASSERT(estimate.is_ready);
    rows.push_back(estimate);
  }
  RC_ASSERT(!estimator.drain(estimate));
  RC_ASSERT(rows.size() == samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    RC_ASSERT(rows[i].time_ns == samples[i].time_ns);
    RC_ASSERT(rows[i].time_valid == (i % 11 != 5 || i % 2 == 0));
    RC_ASSERT(rows[i].axis_count == 1);
    RC_ASSERT(rows[i].events.has(Event::zero_filled) == (i % 7 == 3));
    for (std::size_t event = 0; event < kEventCount; ++event) {
      const auto named = static_cast<Event>(event);
      if (named == Event::noise_at_limit || named == Event::liveliness_at_limit) {
        continue;  // of the noise and the motion as they are now
      }
      // A later sample may have shown it to be one.
      if (named == Event::outlier_rejected && rows[i].events.has(named)) continue;
      RC_ASSERT(rows[i].events.has(named) == prompt_rows[i].events.has(named));
    }
    const auto &axis = rows[i].axes[0], &prompt_axis = prompt_rows[i].axes[0];
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    RC_ASSERT(same(axis.measured_position_m, prompt_axis.measured_position_m));
    RC_ASSERT(same(axis.innovation_m, prompt_axis.innovation_m));
    RC_ASSERT(same(axis.innovation_sd_m, prompt_axis.innovation_sd_m));
    RC_ASSERT(same(rows[i].nis, prompt_rows[i].nis));
  }
}

// Also at the start and at each restart, where the prior is far wider than what is left of it:
// there float may say less, never more.
TEST(FixedLag, FloatSaysWhatDoubleSaysOrLess) {
  for (const double noise_sd_m : {1e-4, 2e-5, 5e-6}) {
    RecommendedEstimator<double, 1> in_double({}, 10);
    RecommendedEstimator<float, 1> in_float({}, 10);
    int without_value = 0, narrower = 0, wider = 0;
    TimeNs time_ns = 0;
    for (TimeNs i = 0; i < 4000; ++i) {
      time_ns += i % 400 == 399 ? 500'000'000 : 16'666'667;
      const double noise = noise_sd_m * static_cast<double>(i * 7919 % 31 - 15) / 9;
      const double z = 0.005 * std::sin(8 * seconds(time_ns)) + noise;
      const auto expected = in_double.step({time_ns, true, {z}, {}});
      const auto actual = in_float.step({time_ns, true, {static_cast<float>(z)}, {}});
      if (!expected.is_ready) continue;
      const Quantity<double>& one = expected.axes[0].velocity_m_s;
      const Quantity<float>& other = actual.axes[0].velocity_m_s;
      without_value += std::isfinite(one.value) && !std::isfinite(other.value);
      const double ratio = static_cast<double>(other.standard_deviation) / one.standard_deviation;
      narrower += ratio < 0.95;
      wider += ratio > 1.05;
    }
    EXPECT_EQ(without_value, 0) << noise_sd_m;
    EXPECT_EQ(narrower, 0) << noise_sd_m;
    EXPECT_LE(wider, 3 * 10) << "the start and nine restarts";
  }
}

TEST(FixedLag, FewerSamplesThanTheLagAreDrainedToo) {
  RecommendedEstimator<double, 1> estimator({}, 16);
  for (TimeNs i = 0; i < 3; ++i) {
    EXPECT_FALSE(estimator.step({i * 10'000'000, true, {0.001}, {}}).is_ready);
  }
  RecommendedEstimate<double> estimate;
  for (TimeNs i = 0; i < 3; ++i) {
    ASSERT_TRUE(estimator.drain(estimate));
    EXPECT_EQ(estimate.time_ns, i * 10'000'000);
    EXPECT_TRUE(std::isfinite(estimate.axes[0].velocity_m_s.value));
  }
  EXPECT_FALSE(estimator.drain(estimate));
}

}  // namespace
}  // namespace condyle
