// SPDX-License-Identifier: Apache-2.0
// The head motion is the joint identification per mass, and says what is not known.
#include "condyle/estimator/head_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "consistency/head_motion_samples.h"

namespace condyle {
namespace {

using testing_support::HeadMotionTruth;
using testing_support::NoddingHead;

HeadMotionParameters relaxed() {
  HeadMotionParameters parameters;
  parameters.delay_sd_s = 0;
  parameters.muscle_share = 0;
  return parameters;
}

template <class Scalar>
HeadMotionEstimate<Scalar> identify(const HeadMotionParameters& parameters, int samples) {
  NoddingHead head({}, 60, 1);
  HeadMotionIdentification<Scalar> stage(parameters);
  for (int i = 0; i < samples; ++i) {
    const auto sample = head.next();
    stage.accelerate(Scalar(1.0 / 60), static_cast<Scalar>(sample.acceleration_m_s2));
    stage.measure(Scalar(1), static_cast<Scalar>(sample.position_m), Scalar(5e-5));
  }
  return stage.estimate();
}

// The stage's own values are kv / m over g and 1 / g; what it says of them gives the variance of
// kv / m back.
TEST(HeadMotion, IsTheStagePerMass) {
  const HeadMotionParameters parameters = relaxed();
  JointParameters joint;
  joint.friction_Ns_m = parameters.damping_rate_per_s;
  joint.mass_kg = {1, parameters.gain_sd};
  joint.stiffness_N_m = parameters.stiffness_per_mass_per_s2;
  joint.offset_N = {0, parameters.offset_sd_m_s2};
  joint.drive.noise_sd_N = parameters.acceleration_noise_sd_m_s2;
  joint.drive.gain_sd = joint.drive.delay_sd_s = joint.drive.missing_share = 0;
  JointIdentification<double> stage(joint);
  NoddingHead head({}, 60, 1);
  for (int i = 0; i < 600; ++i) {
    const auto sample = head.next();
    (void)stage.step(1.0 / 60, -sample.acceleration_m_s2, sample.position_m, 5e-5);
  }
  const auto expected = stage.estimate();
  const auto estimate = identify<double>(parameters, 600);
  const double m = expected.mass_kg.fitted, rate = expected.friction_Ns_m.fitted / m;
  EXPECT_NEAR(estimate.gain, 1 / m, 1e-12);
  EXPECT_NEAR(estimate.damping_rate_per_s.fitted, rate, 1e-9);
  EXPECT_NEAR(estimate.stiffness_per_mass_per_s2.fitted, expected.stiffness_N_m.fitted / m, 1e-9);
  const double of_friction = expected.friction_Ns_m.sampling_sd, of_mass = expected.mass_kg.sampling_sd;
  const double variance =
      (of_friction * of_friction - 2 * rate * expected.friction_mass_covariance +
       rate * rate * of_mass * of_mass) /
      (m * m);
  EXPECT_NEAR(estimate.damping_rate_per_s.sampling_sd, std::sqrt(variance), 1e-6);
  EXPECT_NEAR(estimate.gain_sd, of_mass / (m * m), 1e-9);
}

TEST(HeadMotion, SaysWhatLimits) {
  EXPECT_EQ(identify<double>(relaxed(), 0).damping_rate_per_s.limit, JointLimit::no_drive);
  EXPECT_EQ(identify<double>(relaxed(), 100).damping_rate_per_s.limit, JointLimit::too_early);
  const auto known = identify<double>(relaxed(), 1800);
  EXPECT_EQ(known.damping_rate_per_s.limit, JointLimit::none);
  EXPECT_EQ(known.damping_rate_per_s.quantity.provenance, Provenance::measured);
  EXPECT_EQ(known.stiffness_per_mass_per_s2.limit, JointLimit::none);
  HeadMotionParameters parameters;
  const auto by_default = identify<double>(parameters, 1800);
  EXPECT_EQ(by_default.damping_rate_per_s.limit, JointLimit::missing);
  EXPECT_EQ(by_default.damping_rate_per_s.quantity.provenance, Provenance::assumed);
  EXPECT_EQ(by_default.damping_rate_per_s.quantity.value, parameters.damping_rate_per_s.mean);
  parameters.muscle_share = 0;
  EXPECT_EQ(identify<double>(parameters, 1800).damping_rate_per_s.limit, JointLimit::delay);
  parameters = relaxed();
  parameters.damping_rate_resolution_per_s = 1e-3;
  EXPECT_EQ(identify<double>(parameters, 1800).damping_rate_per_s.limit, JointLimit::resolution);
}

// All of the interval's width that muscles make is the share of the inertial force.
TEST(HeadMotion, MusclesWidenByTheirShare) {
  HeadMotionParameters parameters = relaxed();
  parameters.muscle_share = 0.1;
  const auto estimate = identify<double>(parameters, 1800);
  const auto& damping = estimate.damping_rate_per_s;
  const double expected = 0.1 * estimate.rms_acceleration_m_s2 / estimate.rms_velocity_m_s;
  EXPECT_NEAR(
      std::sqrt(damping.fitted_sd * damping.fitted_sd - damping.sampling_sd * damping.sampling_sd),
      expected, 1e-9);
}

// What an interval is widened by is what an accelerometer that is late by a standard deviation does
// to the value.
TEST(HeadMotion, ADelayWidensByWhatItDoes) {
  constexpr double kLate_s = 0.005;
  const auto of_a_head = [](double delay_s, double said_delay_sd_s, double noise_m_s2) {
    HeadMotionTruth truth;
    truth.delay_s = delay_s;
    truth.acceleration_sd_m_s2 = noise_m_s2;
    HeadMotionParameters parameters = relaxed();
    parameters.delay_sd_s = said_delay_sd_s;
    parameters.gain_sd = 0.3;
    parameters.acceleration_noise_sd_m_s2 = noise_m_s2;
    NoddingHead head(truth, 60, 1);
    HeadMotionIdentification<double> stage(parameters);
    for (int i = 0; i < 1800; ++i) {
      const auto sample = head.next();
      stage.accelerate(1.0 / 60, sample.acceleration_m_s2);
      stage.measure(1, sample.position_m, 5e-5);
    }
    return stage.estimate();
  };
  for (const double noise_m_s2 : {0.05, 0.5}) {
    const auto punctual = of_a_head(0, kLate_s, noise_m_s2);
    const auto late = of_a_head(kLate_s, 0, noise_m_s2);
    const auto widened_by = [](const IdentifiedValue<double>& value) {
      return std::sqrt(value.fitted_sd * value.fitted_sd - value.sampling_sd * value.sampling_sd);
    };
    const double damping = late.damping_rate_per_s.fitted - punctual.damping_rate_per_s.fitted;
    const double stiffness =
        late.stiffness_per_mass_per_s2.fitted - punctual.stiffness_per_mass_per_s2.fitted;
    EXPECT_NEAR(widened_by(punctual.damping_rate_per_s), std::abs(damping), 0.3 * std::abs(damping))
        << noise_m_s2;
    EXPECT_NEAR(widened_by(punctual.stiffness_per_mass_per_s2), std::abs(stiffness),
                0.3 * std::abs(stiffness))
        << noise_m_s2;
  }
}

TEST(HeadMotion, FloatIsAsGood) {
  const auto in_double = identify<double>(relaxed(), 900);
  const auto in_float = identify<float>(relaxed(), 900);
  EXPECT_NEAR(in_float.damping_rate_per_s.fitted, in_double.damping_rate_per_s.fitted,
              0.5 * in_double.damping_rate_per_s.fitted_sd);
  EXPECT_NEAR(in_float.stiffness_per_mass_per_s2.fitted, in_double.stiffness_per_mass_per_s2.fitted,
              0.5 * in_double.stiffness_per_mass_per_s2.fitted_sd);
}

TEST(HeadMotion, GoesOnAfterAGap) {
  NoddingHead head({}, 60, 1);
  HeadMotionIdentification<double> stage(relaxed());
  for (int i = 0; i < 1800; ++i) {
    const auto sample = head.next();
    if (i % 600 >= 500) continue;
    if (i % 600 == 0) stage.interrupt();
    stage.accelerate(1.0 / 60, sample.acceleration_m_s2);
    stage.measure(1, sample.position_m, 5e-5);
  }
  const auto value = stage.estimate().damping_rate_per_s;
  EXPECT_EQ(value.limit, JointLimit::none);
  EXPECT_LT(std::abs(value.fitted - 8), 4 * value.fitted_sd);
}

// At the first acceleration after a gap nothing is known of how it changes.
TEST(HeadMotion, TakesTwoPositionsOfOneInstant) {
  NoddingHead head({}, 60, 1);
  HeadMotionParameters parameters = relaxed();
  parameters.delay_sd_s = 0.005;
  HeadMotionIdentification<double> stage(parameters);
  for (int i = 0; i < 600; ++i) {
    const auto sample = head.next();
    if (i == 300) stage.interrupt();
    stage.accelerate(1.0 / 60, sample.acceleration_m_s2);
    for (int k = 0; k < 2; ++k) stage.measure(1, sample.position_m, 5e-5);
  }
  const auto value = stage.estimate().damping_rate_per_s;
  EXPECT_TRUE(std::isfinite(value.fitted_sd)) << value.fitted_sd;
  EXPECT_GT(value.fitted_sd, value.sampling_sd);
}

TEST(HeadMotion, ParametersAreChecked) {
  EXPECT_TRUE(is_valid(HeadMotionParameters{}));
  EXPECT_FALSE(is_valid(HeadMotionParameters{.gain_sd = 0}));
  EXPECT_FALSE(is_valid(HeadMotionParameters{.muscle_share = 1.1}));
  EXPECT_FALSE(is_valid(HeadMotionParameters{.damping_rate_per_s = {std::nan(""), 1}}));
}

}  // namespace
}  // namespace condyle
