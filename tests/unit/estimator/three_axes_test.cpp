// SPDX-License-Identifier: Apache-2.0
// The recommended estimator along three axes.
#include <gtest/gtest.h>

#include "condyle/estimator/motion/recommended_estimator.h"
#include "support/random.h"

namespace condyle {
namespace {

using testing_support::Random;
using Estimator = RecommendedEstimator<double, 3>;

constexpr TimeNs kStep_ns = 16'666'667;

double chewing_m(TimeNs i, double phase) {
  const double t = seconds(i * kStep_ns);
  return 0.007 * std::sin(8 * t + phase) + 0.002 * std::sin(16 * t + 2 * phase);
}

void expect_same(const Quantity<double>& a, const Quantity<double>& b, double tolerance) {
  EXPECT_NEAR(a.value, b.value, tolerance * a.standard_deviation);
  EXPECT_NEAR(a.standard_deviation, b.standard_deviation, tolerance * a.standard_deviation);
  EXPECT_EQ(a.provenance, b.provenance);
}

void expect_same(const AxisEstimate<double>& a, const AxisEstimate<double>& b, double tolerance) {
  expect_same(a.position_m, b.position_m, tolerance);
  expect_same(a.velocity_m_s, b.velocity_m_s, tolerance);
  expect_same(a.acceleration_m_s2, b.acceleration_m_s2, tolerance);
  expect_same(a.force_N, b.force_N, tolerance);
  EXPECT_DOUBLE_EQ(a.noise_sd_m, b.noise_sd_m);
  EXPECT_DOUBLE_EQ(a.jerk_density_m2_s5, b.jerk_density_m2_s5);
}

TEST(ThreeAxes, TheSamePositionsGiveTheSameAsAlongOne) {
  for (const Adaptation adaptation : {Adaptation::on, Adaptation::off}) {
    for (const int lag : {0, 5}) {
      MotionEstimatorParameters parameters;
      parameters.noise.adaptation = adaptation;
      // Beyond, three axes know more than one.
      parameters.outliers.huber_sd = parameters.outliers.gate_sd = 100;
      Estimator three(parameters, lag);
      RecommendedEstimator<double, 1> one(parameters, lag);
      Random random(1);
      for (TimeNs i = 0; i < 500; ++i) {
        const double z = chewing_m(i, 0) + 1e-4 * random.normal();
        const bool is_measured = i % 31 != 9;
        const auto of_one = one.step({i * kStep_ns, is_measured, {z}, {}});
        const auto of_three = three.step({i * kStep_ns, is_measured, {z, z, z}, {}});
        ASSERT_EQ(of_three.is_ready, of_one.is_ready);
        if (!of_one.is_ready) continue;
        EXPECT_EQ(of_three.axis_count, 3);
        for (const auto& axis : of_three.axes) expect_same(axis, of_three.axes[0], 0);
        expect_same(of_three.axes[0], of_one.axes[0], 1e-12);
        if (std::isnan(of_one.nis)) continue;
        EXPECT_NEAR(of_three.nis, 3 * of_one.nis, 1e-12 * of_one.nis);
      }
    }
  }
}

TEST(ThreeAxes, EachAxisNoiseIsLearnedByItself) {
  const double sd[] = {20e-6, 50e-6, 200e-6};
  Estimator estimator({});
  Random random(2);
  RecommendedEstimate<double> estimate;
  for (TimeNs i = 0; i < 3600; ++i) {
    TimedPosition<double, 3> measurement{i * kStep_ns, true, {}, {}};
    for (int axis = 0; axis < 3; ++axis) {
      measurement.position_m[axis] = chewing_m(i, axis) + sd[axis] * random.normal();
    }
    estimate = estimator.step(measurement);
    if (i < 720) continue;  // 12 s
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(estimate.axes[axis].noise_sd_m / sd[axis], 1, 0.25) << axis << " at " << i;
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    RecordProperty("noise_um_" + std::to_string(axis),
                   std::to_string(1e6 * estimate.axes[axis].noise_sd_m));
  }
}

TEST(ThreeAxes, GivenNoiseIsThatOfItsAxis) {
  MotionEstimatorParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  const double sd[] = {20e-6, 50e-6, 200e-6};
  Estimator three(parameters);
  three.set_noise(sd);
  for (int axis = 0; axis < 3; ++axis) {
    RecommendedEstimator<double, 1> one(parameters);
    one.set_noise({sd[axis]});
    Estimator all = three;
    for (TimeNs i = 0; i < 100; ++i) {
      const double z = chewing_m(i, 0);
      const auto of_one = one.step({i * kStep_ns, true, {z}, {}});
      const auto of_all = all.step({i * kStep_ns, true, {z, z, z}, {}});
      expect_same(of_all.axes[axis], of_one.axes[0], 1e-12);
      EXPECT_DOUBLE_EQ(of_all.axes[axis].noise_sd_m, sd[axis]);
    }
  }
}

TEST(ThreeAxes, AGlitchOrAMissingValueAlongOneAxisIsTheWholeSamples) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double bad : {0.05, std::nan("")}) {
      Estimator with(MotionEstimatorParameters{}), without(MotionEstimatorParameters{});
      Random random(3);
      for (TimeNs i = 0; i <= 200; ++i) {
        TimedPosition<double, 3> measurement{i * kStep_ns, true, {}, {}};
        for (int j = 0; j < 3; ++j) {
          measurement.position_m[j] = chewing_m(i, j) + 5e-5 * random.normal();
        }
        if (i < 200) {
          with.step(measurement);
          without.step(measurement);
          continue;
        }
        measurement.position_m[axis] += bad;
        const auto bad_estimate = with.step(measurement);
        EXPECT_TRUE(bad_estimate.events.has(std::isnan(bad) ? Event::position_missing
                                                            : Event::outlier_rejected));
        measurement.is_measured = false;
        const auto missing = without.step(measurement);
        for (int j = 0; j < 3; ++j) {
          EXPECT_EQ(bad_estimate.axes[j].position_m.provenance, Provenance::derived);
          EXPECT_NE(bad_estimate.axes[j].velocity_m_s.provenance, Provenance::measured);
          for (int k = 0; k < with.bank().member_count(); ++k) {
            EXPECT_EQ(with.bank().step(k).x[j], without.bank().step(k).x[j]);
          }
          // A glitch may also be a change of the motion, if hardly: that widens what is said.
          EXPECT_GE(bad_estimate.axes[j].position_m.standard_deviation,
                    missing.axes[j].position_m.standard_deviation);
        }
      }
    }
  }
}

}  // namespace
}  // namespace condyle
