// SPDX-License-Identifier: Apache-2.0
// What the recommended estimator does with samples that are not as they should be.
#include "condyle/estimator/motion/recommended_estimator.h"

#include <cstring>

#include "support/rapidcheck_gtest.h"
#include "unit/estimator/axis_samples.h"

namespace condyle {
namespace {

using testing_support::number_between;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr TimeNs kStep_ns = 10'000'000;

using Estimator = RecommendedEstimator<double, 1>;
using Estimate = RecommendedEstimate<double>;

TimedPosition<double, 1> at(TimeNs time_ns, double position_m, bool is_measured = true) {
  return {time_ns, is_measured, {position_m}, {}};
}

double swing_m(TimeNs time_ns) {
  return 0.005 * std::sin(8 * seconds(time_ns));
}

// An estimator that has followed a swing for `count` samples, the last at (count - 1) steps.
Estimator after_swing(TimeNs count, const MotionEstimatorParameters& parameters = {}) {
  Estimator estimator(parameters);
  for (TimeNs i = 0; i < count; ++i) {
    EXPECT_TRUE(estimator.step(at(i * kStep_ns, swing_m(i * kStep_ns))).is_ready);
  }
  return estimator;
}

bool has_values(const Estimate& estimate) {
  return std::isfinite(estimate.axes[0].position_m.value);
}

// Every state and covariance of the bank, bit for bit.
bool same_states(const Estimator& a, const Estimator& b) {
  for (int i = 0; i < a.bank().member_count(); ++i) {
    const auto &one = a.bank().step(i), &other = b.bank().step(i);
    if (std::memcmp(one.x, other.x, sizeof one.x) != 0 ||
        std::memcmp(&one.P, &other.P, sizeof one.P) != 0) {
      return false;
    }
  }
  return a.bank().noise_variance_m2(0) == b.bank().noise_variance_m2(0) &&
         a.bank().jerk_density_m2_s5(0) == b.bank().jerk_density_m2_s5(0);
}

TEST(RecommendedEstimator, SaysNothingBeforeTheFirstPosition) {
  for (const double position_m : {0.0, kNaN, kInfinity}) {
    Estimator estimator({});
    for (TimeNs i = 0; i < 100; ++i) {  // longer than the longest gap
      const auto estimate = estimator.step(at(i * kStep_ns, position_m, std::isnan(position_m)));
      if (std::isinf(position_m)) break;
      EXPECT_TRUE(estimate.is_ready);
      EXPECT_TRUE(estimate.events.has(Event::not_started));
      EXPECT_FALSE(estimate.events.has(Event::state_lost));
      EXPECT_EQ(estimate.events.has(Event::position_missing), std::isnan(position_m));
      EXPECT_FALSE(has_values(estimate));
    }
    const auto estimate = estimator.step(at(1'000 * kStep_ns, 0.001));
    EXPECT_TRUE(estimate.events.empty());
    EXPECT_EQ(estimate.axes[0].position_m.value, 0.001);
  }
}

TEST(RecommendedEstimator, WhatIsNoNumberEntersNoState) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    Estimator with_bad = after_swing(50), without = after_swing(50);
    const auto estimate = with_bad.step(at(50 * kStep_ns, bad));
    EXPECT_TRUE(estimate.events.has(Event::position_missing));
    EXPECT_TRUE(std::isnan(estimate.axes[0].measured_position_m));
    EXPECT_TRUE(std::isnan(estimate.axes[0].innovation_m));
    EXPECT_TRUE(has_values(estimate));
    EXPECT_FALSE(without.step(at(50 * kStep_ns, 0, false)).events.has(Event::position_missing));
    EXPECT_TRUE(same_states(with_bad, without));
    for (TimeNs i = 51; i < 60; ++i) {
      with_bad.step(at(i * kStep_ns, swing_m(i * kStep_ns)));
      without.step(at(i * kStep_ns, swing_m(i * kStep_ns)));
      EXPECT_TRUE(same_states(with_bad, without));
    }
  }
}

TEST(RecommendedEstimator, ATimeBeforeTheLastIsNotTaken) {
  Estimator estimator = after_swing(50), without = after_swing(50);
  for (const TimeNs time_ns : {49 * kStep_ns - 1, TimeNs{-5}, INT64_MIN}) {
    const auto estimate = estimator.step(at(time_ns, 0.7));
    EXPECT_TRUE(estimate.events.has(Event::time_reversed));
    EXPECT_EQ(estimate.time_ns, time_ns);
    EXPECT_FALSE(has_values(estimate));
    EXPECT_TRUE(std::isnan(estimate.axes[0].measured_position_m));
    EXPECT_TRUE(same_states(estimator, without));
  }
  const auto one = estimator.step(at(50 * kStep_ns, 0.001));
  const auto other = without.step(at(50 * kStep_ns, 0.001));
  EXPECT_EQ(one.axes[0].velocity_m_s.value, other.axes[0].velocity_m_s.value);
  EXPECT_TRUE(same_states(estimator, without));
}

TEST(RecommendedEstimator, ARepeatedTimeIsASecondMeasurementOfTheSameInstant) {
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  Estimator estimator = after_swing(50, parameters);
  double sd = 1;
  for (int i = 0; i < 20; ++i) {
    const auto estimate = estimator.step(at(49 * kStep_ns, swing_m(49 * kStep_ns)));
    EXPECT_TRUE(estimate.events.empty());
    EXPECT_LT(estimate.axes[0].position_m.standard_deviation, sd);
    sd = estimate.axes[0].position_m.standard_deviation;
  }
  // Twenty of them leave about R / 20.
  EXPECT_NEAR(sd, parameters.noise.position_sd_m / std::sqrt(21), 5e-7);
}

TEST(RecommendedEstimator, NothingIsKnownAfterTheLongestGap) {
  const MotionEstimatorParameters parameters;
  Estimator estimator = after_swing(50);
  TimeNs time_ns = 49 * kStep_ns;
  const TimeNs lost_ns = time_ns + nanoseconds(parameters.outliers.longest_gap_s);
  double sd = 0;
  for (time_ns += kStep_ns; time_ns <= lost_ns + 10 * kStep_ns; time_ns += kStep_ns) {
    const auto estimate = estimator.step(at(time_ns, 0, false));
    const bool is_lost = time_ns > lost_ns;
    EXPECT_EQ(has_values(estimate), !is_lost) << time_ns;
    EXPECT_EQ(estimate.events.has(Event::state_lost), is_lost);
    EXPECT_FALSE(estimate.events.has(Event::not_started));
    if (is_lost) continue;
    EXPECT_GT(estimate.axes[0].velocity_m_s.standard_deviation, sd);
    sd = estimate.axes[0].velocity_m_s.standard_deviation;
  }
  const auto estimate = estimator.step(at(time_ns, 0.002));
  EXPECT_TRUE(estimate.events.has(Event::state_restarted));
  EXPECT_FALSE(estimate.events.has(Event::state_lost));
  EXPECT_EQ(estimate.axes[0].position_m.value, 0.002);
  EXPECT_EQ(estimate.axes[0].velocity_m_s.value, 0);
  EXPECT_TRUE(std::isnan(estimate.nis));
  EXPECT_TRUE(estimator.step(at(time_ns + kStep_ns, 0.002)).events.empty());
}

TEST(RecommendedEstimator, AMeasurementRightAfterTheGapStartsAnew) {
  Estimator estimator = after_swing(50);
  const double noise_variance = estimator.bank().noise_variance_m2(0);
  const auto estimate = estimator.step(at(49 * kStep_ns + 250'000'001, 0.3));
  EXPECT_TRUE(estimate.events.has(Event::state_restarted));
  EXPECT_EQ(estimate.axes[0].position_m.value, 0.3);
  // What is known of the instrument stays.
  EXPECT_EQ(estimator.bank().noise_variance_m2(0), noise_variance);
}

// A rejected sample is no measurement: the gap goes on.
TEST(RecommendedEstimator, RejectedSamplesDoNotKeepTheStateAlive) {
  MotionEstimatorParameters parameters;
  parameters.outliers.reset_after = 1000;
  parameters.outliers.longest_gap_s = 0.1;
  Estimator estimator = after_swing(50, parameters);
  Estimate estimate;
  for (TimeNs i = 50; i < 50 + 10; ++i) {
    estimate = estimator.step(at(i * kStep_ns, i % 2 == 0 ? 5 : -5));
    ASSERT_TRUE(is_unexpected(estimate.events)) << i;
    EXPECT_FALSE(estimate.events.has(Event::state_restarted));
  }
  estimate = estimator.step(at(60 * kStep_ns, 5));
  EXPECT_TRUE(estimate.events.has(Event::state_restarted));
}

// Both hypotheses are kept until it has stayed for some samples; then the new place is the
// motion's.
TEST(RecommendedEstimator, ADisplacementThatStaysBecomesTheMotion) {
  for (const double size_m : {0.003, 0.5}) {
    Estimator estimator = after_swing(100);
    for (TimeNs i = 100; i < 140; ++i) {
      const double truth_m = size_m + swing_m(i * kStep_ns);
      const auto estimate = estimator.step(at(i * kStep_ns, truth_m));
      const auto& axis = estimate.axes[0];
      EXPECT_FALSE(estimate.events.has(Event::state_restarted));
      if (is_unexpected(estimate.events)) {
        EXPECT_LT(i, 106);
      }
      EXPECT_LE(estimator.motion().has_other(), is_unexpected(estimate.events)) << i;
      if (i >= 101) {
        EXPECT_LE(std::abs(axis.position_m.value - truth_m), 5 * axis.position_m.standard_deviation)
            << i;
      }
      if (i < 115) continue;
      EXPECT_NEAR(axis.velocity_m_s.value, 0.04 * std::cos(8 * 0.01 * double(i)), 0.01);
    }
    EXPECT_FALSE(estimator.motion().has_other());
  }
}

// One that comes back was a glitch, and the velocity stays that of the motion.
TEST(RecommendedEstimator, AGlitchLeavesTheMotion) {
  for (const double size_m : {0.001, -0.02, 0.5}) {
    Estimator with = after_swing(100), without = after_swing(100);
    with.step(at(100 * kStep_ns, size_m + swing_m(100 * kStep_ns)));
    EXPECT_TRUE(with.motion().has_other());
    without.step(at(100 * kStep_ns, 0, false));
    const auto one = with.step(at(101 * kStep_ns, swing_m(101 * kStep_ns)));
    const auto other = without.step(at(101 * kStep_ns, swing_m(101 * kStep_ns)));
    EXPECT_FALSE(with.motion().has_other());
    EXPECT_TRUE(same_states(with, without));
    EXPECT_EQ(one.axes[0].velocity_m_s.value, other.axes[0].velocity_m_s.value);
  }
}

// Samples that fit neither hypothesis: after so many in a row the last of them is all that counts.
// Then the next is an outlier to that.
TEST(RecommendedEstimator, SamplesThatFitNothingStartItAnew) {
  Estimator estimator = after_swing(100);
  int restarts = 0;
  for (TimeNs i = 100; i < 130; ++i) {
    const double position_m = i % 2 == 0 ? 5 : -8;
    const auto estimate = estimator.step(at(i * kStep_ns, position_m));
    if (!estimate.events.has(Event::state_restarted)) continue;
    ++restarts;
    EXPECT_EQ(estimate.axes[0].position_m.value, position_m);
  }
  EXPECT_GE(restarts, 1);
}

TEST(RecommendedEstimator, ASetClockStartsTheMotionAnewAndKeepsTheNoise) {
  Estimator estimator = after_swing(200);
  const double noise_variance = estimator.bank().noise_variance_m2(0);
  estimator.restart_clock();
  auto estimate = estimator.step(at(-7 * kStep_ns, 0, false));
  EXPECT_TRUE(estimate.events.has(Event::state_lost));
  EXPECT_FALSE(estimate.events.has(Event::time_reversed));
  estimate = estimator.step(at(-6 * kStep_ns, 0.02));
  EXPECT_TRUE(estimate.events.has(Event::state_restarted));
  EXPECT_EQ(estimate.axes[0].position_m.value, 0.02);
  EXPECT_EQ(estimator.bank().noise_variance_m2(0), noise_variance);
}

// Its times then mean something else, even where they go on as if nothing had happened.
TEST(RecommendedEstimator, ASetClockStartsTheMotionAnewWhereverItIsSet) {
  Estimator estimator = after_swing(200);
  estimator.restart_clock();
  const auto estimate = estimator.step(at(200 * kStep_ns, swing_m(200 * kStep_ns)));
  EXPECT_TRUE(estimate.events.has(Event::state_restarted));
  EXPECT_EQ(estimate.axes[0].velocity_m_s.value, 0);
}

TEST(RecommendedEstimator, ASkippedSampleLeavesTheState) {
  Estimator estimator = after_swing(50), without = after_swing(50);
  const auto estimate = estimator.skip(at(-1, kNaN), false);
  EXPECT_TRUE(estimate.is_ready);
  EXPECT_FALSE(estimate.time_valid);
  EXPECT_FALSE(has_values(estimate));
  EXPECT_TRUE(same_states(estimator, without));
}

// Times, positions and settings from everything that a caller could come up with.
rc::Gen<TimeNs> any_step_ns() {
  return rc::gen::weightedOneOf<TimeNs>(
      {{20, rc::gen::just<TimeNs>(16'666'667)},
       {4, rc::gen::inRange<TimeNs>(0, 100'000'000)},
       {1, rc::gen::element<TimeNs>(0, 1, 249'999'999, 250'000'000, 1'000'000'000'000'000, -1,
                                    -20'000'000, INT64_MAX, INT64_MIN)}});
}

template <class Scalar>
rc::Gen<Scalar> any_position_m() {
  using Limits = std::numeric_limits<Scalar>;
  return rc::gen::weightedOneOf<Scalar>(
      {{20, rc::gen::cast<Scalar>(number_between(-0.01, 0.01))},
       {2, rc::gen::just(Scalar(0))},
       {1,
        rc::gen::element<Scalar>(Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(),
                                 Limits::max(), Limits::lowest(), Limits::min(),
                                 Limits::denorm_min(), Scalar(1e3), Scalar(-1e-9), Scalar(1e15))}});
}

// A value has a standard deviation and a provenance, or there is none of the three.
template <class Scalar>
void expect_whole(const Quantity<Scalar>& quantity) {
  const bool exists = quantity.provenance != Provenance::not_computed;
  RC_ASSERT(std::isfinite(quantity.value) == exists);
  RC_ASSERT(std::isfinite(quantity.standard_deviation) == exists);
  if (exists) RC_ASSERT(quantity.standard_deviation >= Scalar(0));
  if (!exists) RC_ASSERT(std::isnan(quantity.value) && std::isnan(quantity.standard_deviation));
}

template <class Scalar>
void expect_whole(const RecommendedEstimate<Scalar>& estimate, int axes,
                  const MotionEstimatorParameters& parameters) {
  RC_ASSERT(!std::isnan(estimate.nis) == !std::isnan(estimate.axes[0].innovation_m));
  for (int axis = 0; axis < axes; ++axis) {
    const AxisEstimate<Scalar>& one = estimate.axes[axis];
    expect_whole(one.position_m);
    expect_whole(one.velocity_m_s);
    expect_whole(one.acceleration_m_s2);
    expect_whole(one.force_N);
    RC_ASSERT(one.force_N.provenance != Provenance::measured);
    RC_ASSERT(std::isnan(one.innovation_m) == std::isnan(one.innovation_sd_m));
    if (one.position_m.provenance == Provenance::not_computed) continue;
    if (parameters.noise.adaptation == Adaptation::off) continue;
    RC_ASSERT(one.noise_sd_m >= Scalar(parameters.noise.lowest_position_sd_m * (1 - 1e-6)));
    RC_ASSERT(one.noise_sd_m <= Scalar(parameters.noise.highest_position_sd_m * (1 + 1e-6)));
    RC_ASSERT(one.jerk_density_m2_s5 > Scalar(0));
  }
}

template <class Scalar>
bool is_positive_definite(const SymmetricMatrix3<Scalar>& P) {
  Eigen::Matrix3d dense = P.dense().template cast<double>();
  const Eigen::Vector3d unit = dense.diagonal().cwiseSqrt().cwiseInverse();
  dense = Eigen::Matrix3d(unit.asDiagonal() * dense * unit.asDiagonal());
  return dense.allFinite() && dense.llt().info() == Eigen::Success;
}

enum class Covariance { is_checked, may_round };

template <class Scalar, int kAxes>
void expect_survival(const MotionEstimatorParameters& parameters,
                     Covariance covariance = Covariance::is_checked) {
  const int lag = *rc::gen::element(0, 0, 1, 3, 16);
  RecommendedEstimator<Scalar, kAxes> estimator(parameters, lag);
  TimeNs time_ns = *rc::gen::element<TimeNs>(0, INT64_MIN, INT64_MAX - 10'000'000'000);
  const auto steps = *rc::gen::noShrink(rc::gen::container<std::vector<TimeNs>>(80, any_step_ns()));
  const auto positions = *rc::gen::noShrink(
      rc::gen::container<std::vector<Scalar>>(80 * kAxes, any_position_m<Scalar>()));
  std::size_t next = 0;
  for (const TimeNs step_ns : steps) {
    // Wraps around, as a clock does.
    time_ns = static_cast<TimeNs>(static_cast<std::uint64_t>(time_ns) +
                                  static_cast<std::uint64_t>(step_ns));
    TimedPosition<Scalar, kAxes> measurement{time_ns, next % 7 != 3, {}, {}};
    for (Scalar& position_m : measurement.position_m) position_m = positions[next++];
    const auto estimate = estimator.step(measurement);
    expect_whole(estimate, kAxes, parameters);
    if (covariance == Covariance::may_round) continue;
    RC_ASSERT(!estimate.events.has(Event::update_refused));
    if (lag > 0 || estimate.axes[0].position_m.provenance == Provenance::not_computed) continue;
    for (int i = 0; i < estimator.bank().member_count(); ++i) {
      RC_ASSERT(is_positive_definite(estimator.bank().step(i).P));
    }
  }
  RecommendedEstimate<Scalar> estimate;
  while (estimator.drain(estimate)) expect_whole(estimate, kAxes, parameters);
}

MotionEstimatorParameters default_or_fixed() {
  MotionEstimatorParameters parameters;
  if (*rc::gen::arbitrary<bool>()) parameters.noise.adaptation = Adaptation::off;
  return parameters;
}

RC_GTEST_PROP(RecommendedEstimator, SurvivesAnythingInDouble, ()) {
  expect_survival<double, 1>(default_or_fixed());
}
// In float the liveliest member, which expects 10^5 times the noise, leaves no more of a covariance
// than rounding does where a step is far shorter than the mean.
RC_GTEST_PROP(RecommendedEstimator, SurvivesAnythingInFloat, ()) {
  expect_survival<float, 1>(default_or_fixed(), Covariance::may_round);
}
RC_GTEST_PROP(RecommendedEstimator, SurvivesAnythingOnThreeAxesInDouble, ()) {
  expect_survival<double, 3>(default_or_fixed());
}
RC_GTEST_PROP(RecommendedEstimator, SurvivesAnythingOnThreeAxesInFloat, ()) {
  expect_survival<float, 3>(default_or_fixed(), Covariance::may_round);
}

// Parameters anywhere in their ranges. A prior that is 1e8 times as wide as the noise, with steps
// that make the most of it, leaves less of a variance than rounding does.
MotionEstimatorParameters any_parameters() {
  MotionEstimatorParameters parameters = default_or_fixed();
  visit_motion_fields(parameters, [](const char*, const char*, double* values, std::size_t,
                                     const char*, Range range) {
    const double lowest = std::max(range.lowest, 1e-9);
    *values = *number_between(std::log(lowest), std::log(range.highest));
    *values = std::clamp(std::exp(*values), range.lowest, range.highest);
  });
  auto& [adaptation, sd, rotation, density, memory, lowest, highest] = parameters.noise;
  if (lowest >= highest) lowest = highest / 2 < 1e-8 ? 1e-8 : highest / 2;
  if (lowest >= highest) highest = 2 * lowest;
  if (parameters.outliers.huber_sd > parameters.outliers.gate_sd) {
    parameters.outliers.huber_sd = parameters.outliers.gate_sd;
  }
  return parameters;
}

RC_GTEST_PROP(RecommendedEstimator, SurvivesAnyParametersInDouble, ()) {
  expect_survival<double, 1>(any_parameters(), Covariance::may_round);
}
RC_GTEST_PROP(RecommendedEstimator, SurvivesAnyParametersInFloat, ()) {
  expect_survival<float, 1>(any_parameters(), Covariance::may_round);
}

}  // namespace
}  // namespace condyle
