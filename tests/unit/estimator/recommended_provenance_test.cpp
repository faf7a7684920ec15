// SPDX-License-Identifier: Apache-2.0
// Where the recommended estimator says its values come from.
#include <gtest/gtest.h>

#include "condyle/estimator/motion/recommended_estimator.h"

namespace condyle {
namespace {

using Estimator = RecommendedEstimator<double, 1>;

RecommendedEstimate<double> step(Estimator& estimator, TimeNs i, double position_m,
                                 bool is_measured = true) {
  return estimator.step({i * 10'000'000, is_measured, {position_m}, {}});
}

double swing_m(TimeNs i) {
  return 0.005 * std::sin(0.08 * static_cast<double>(i));
}

void expect(const RecommendedEstimate<double>& estimate, Provenance position, Provenance velocity,
            Provenance acceleration, Provenance force) {
  EXPECT_EQ(estimate.axes[0].position_m.provenance, position);
  EXPECT_EQ(estimate.axes[0].velocity_m_s.provenance, velocity);
  EXPECT_EQ(estimate.axes[0].acceleration_m_s2.provenance, acceleration);
  EXPECT_EQ(estimate.axes[0].force_N.provenance, force);
}

constexpr auto kMeasured = Provenance::measured, kDerived = Provenance::derived,
               kAssumed = Provenance::assumed;

TEST(RecommendedProvenance, OnePositionMeasuresAPositionAlone) {
  for (const Adaptation adaptation : {Adaptation::on, Adaptation::off}) {
    MotionEstimatorParameters parameters;
    parameters.noise.adaptation = adaptation;
    Estimator estimator(parameters);
    const Provenance position = adaptation == Adaptation::on ? kAssumed : kMeasured;
    expect(step(estimator, 0, 0.001), position, kAssumed, kAssumed, kAssumed);
  }
}

TEST(RecommendedProvenance, SomeMorePositionsMeasureTheMotion) {
  Estimator estimator({});
  RecommendedEstimate<double> estimate;
  for (TimeNs i = 0; i < 30; ++i) estimate = step(estimator, i, swing_m(i));
  expect(estimate, kMeasured, kMeasured, kMeasured, kDerived);
}

// The intervals of the first samples rest on a guess of the noise.
TEST(RecommendedProvenance, WhileTheNoiseIsGuessedAllIsAssumed) {
  Estimator estimator({});
  for (TimeNs i = 0; i < 30; ++i) {
    const Provenance known = i < 15 ? kAssumed : kMeasured;
    expect(step(estimator, i, swing_m(i)), known, known, known, i < 15 ? kAssumed : kDerived);
  }
}

// As long as most samples are farther off than the noise allows, it is not the noise.
TEST(RecommendedProvenance, AGuessThatIsFarTooLowIsDoubtedLonger) {
  Estimator estimator({});
  int assumed = 0;
  for (TimeNs i = 0; i < 200; ++i) {
    const auto estimate = step(estimator, i, i * i % 7 % 2 == 0 ? 0.01 : -0.01);
    assumed += estimate.axes[0].position_m.provenance == kAssumed ? 1 : 0;
  }
  EXPECT_GT(assumed, 20);
  EXPECT_LT(assumed, 100);
}

// The threshold is the one that provenance.h documents, on the values that are reported.
TEST(RecommendedProvenance, MeasuredIsHalfOfThePriorsVariance) {
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  Estimator estimator(parameters);
  bool was_assumed = false, was_measured = false;
  for (TimeNs i = 0; i < 30; ++i) {
    const auto axis = step(estimator, i, swing_m(i)).axes[0];
    const auto half = [](double sd, double prior_sd) {
      return sd * sd <= 0.5 * prior_sd * prior_sd;
    };
    EXPECT_EQ(axis.velocity_m_s.provenance == kMeasured,
              half(axis.velocity_m_s.standard_deviation, parameters.prior.velocity_sd_m_s));
    const bool is_measured =
        half(axis.acceleration_m_s2.standard_deviation, parameters.prior.acceleration_sd_m_s2);
    EXPECT_EQ(axis.acceleration_m_s2.provenance == kMeasured, is_measured);
    (is_measured ? was_measured : was_assumed) = true;
  }
  EXPECT_TRUE(was_assumed && was_measured);
}

TEST(RecommendedProvenance, WhatWasNotTakenIsDerived) {
  Estimator estimator({});
  for (TimeNs i = 0; i < 50; ++i) step(estimator, i, swing_m(i));
  expect(step(estimator, 50, 0, false), kDerived, kDerived, kDerived, kDerived);
  expect(step(estimator, 51, swing_m(51)), kMeasured, kMeasured, kMeasured, kDerived);
  const auto rejected = step(estimator, 52, 0.5);
  EXPECT_TRUE(rejected.events.has(Event::outlier_rejected));
  // Were it a change after all, it would say nothing of the velocity.
  expect(rejected, kDerived, kAssumed, kAssumed, kAssumed);
}

// The longer nothing is measured, the less is known, until only the prior is left.
TEST(RecommendedProvenance, WithoutMeasurementsItBecomesAssumed) {
  MotionEstimatorParameters parameters;
  parameters.outliers.longest_gap_s = 10;
  parameters.noise.adaptation = Adaptation::off;
  Estimator estimator(parameters);
  for (TimeNs i = 0; i < 50; ++i) step(estimator, i, swing_m(i));
  const auto estimate = step(estimator, 50 + 300, 0, false);
  expect(estimate, kDerived, kAssumed, kAssumed, kAssumed);
}

TEST(RecommendedProvenance, ALaterLookMeasuresWhatTheInstantDidNot) {
  Estimator estimator({}, 16);
  RecommendedEstimate<double> first;
  for (TimeNs i = 0; i <= 16; ++i) first = step(estimator, i, swing_m(i), i != 1);
  EXPECT_EQ(first.time_ns, 0);
  EXPECT_EQ(first.axes[0].velocity_m_s.provenance, kMeasured);
  const auto second = step(estimator, 17, swing_m(17));  // of the missing sample
  expect(second, kDerived, kDerived, kDerived, kDerived);
}

TEST(RecommendedProvenance, ForceIsTheAssumedMassTimesTheAcceleration) {
  MotionEstimatorParameters parameters;
  parameters.assumed_mass_kg = 0.4;
  Estimator estimator(parameters);
  for (TimeNs i = 0; i < 50; ++i) {
    const auto axis = step(estimator, i, swing_m(i), i % 9 != 4).axes[0];
    EXPECT_EQ(axis.force_N.value, 0.4 * axis.acceleration_m_s2.value);
    EXPECT_EQ(axis.force_N.standard_deviation, 0.4 * axis.acceleration_m_s2.standard_deviation);
    EXPECT_LE(axis.force_N.provenance, kDerived);
  }
}

}  // namespace
}  // namespace condyle
