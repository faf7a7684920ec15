// SPDX-License-Identifier: Apache-2.0
// Head motion is the identification of a known mass, and says what is not known.
#include "condyle/estimator/impedance/head_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "support/head_motion_samples.h"

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

// Gives the samples of a head that nods at 60 Hz, with `keep(i)`; the first `samples`.
template <class Scalar, class Keep>
HeadMotionEstimate<Scalar> identify(const HeadMotionTruth& truth,
                                    const HeadMotionParameters& parameters, int samples,
                                    const Keep& keep) {
  NoddingHead head(truth, 60, 1);
  const auto identification = std::make_unique<HeadMotionIdentification<Scalar>>(parameters);
  for (int i = 0; i < samples; ++i) {
    const auto sample = head.next();
    if (!keep(i)) continue;
    const TimeNs time_ns = nanoseconds(i / 60.0);
    identification->add_acceleration(time_ns, static_cast<Scalar>(sample.acceleration_m_s2));
    identification->add_position(time_ns, static_cast<Scalar>(sample.position_m));
  }
  identification->conclude();
  return identification->estimate();
}
template <class Scalar>
HeadMotionEstimate<Scalar> identify(const HeadMotionParameters& parameters, int samples,
                                    const HeadMotionTruth& truth = {}) {
  return identify<Scalar>(truth, parameters, samples, [](int) { return true; });
}

TEST(HeadMotion, SaysWhatLimits) {
  EXPECT_EQ(identify<double>(relaxed(), 0).damping_rate_per_s.limit, ImpedanceLimit::no_drive);
  EXPECT_EQ(identify<double>(relaxed(), 300).damping_rate_per_s.limit, ImpedanceLimit::too_early);
  const auto known = identify<double>(relaxed(), 1800);
  EXPECT_EQ(known.damping_rate_per_s.limit, ImpedanceLimit::none);
  EXPECT_EQ(known.damping_rate_per_s.quantity.provenance, Provenance::measured);
  EXPECT_EQ(known.stiffness_per_mass_per_s2.limit, ImpedanceLimit::none);
  HeadMotionParameters parameters;
  const auto by_default = identify<double>(parameters, 1800);
  EXPECT_EQ(by_default.damping_rate_per_s.limit, ImpedanceLimit::missing);
  EXPECT_EQ(by_default.damping_rate_per_s.quantity.provenance, Provenance::assumed);
  EXPECT_EQ(by_default.damping_rate_per_s.quantity.value, parameters.damping_rate_per_s.mean);
  parameters.muscle_share = 0;
  EXPECT_EQ(identify<double>(parameters, 1800).damping_rate_per_s.limit, ImpedanceLimit::delay);
  parameters = relaxed();
  parameters.damping_rate_resolution_per_s = 1e-3;
  parameters.gain_sd = 0;
  EXPECT_EQ(identify<double>(parameters, 1800).damping_rate_per_s.limit,
            ImpedanceLimit::resolution);
  parameters.lever_sd = 0.9;
  EXPECT_EQ(identify<double>(parameters, 1800).damping_rate_per_s.limit, ImpedanceLimit::gain);
}

// The noise of both, and the gain that the motion itself shows.
TEST(HeadMotion, ShowsTheInstruments) {
  HeadMotionTruth truth;
  truth.gain = 1.01;
  const auto estimate = identify<double>(relaxed(), 3600, truth);
  EXPECT_NEAR(estimate.position_noise_sd_m, truth.position_sd_m, 0.1 * truth.position_sd_m);
  EXPECT_NEAR(estimate.acceleration_noise_sd_m_s2, truth.acceleration_sd_m_s2,
              0.1 * truth.acceleration_sd_m_s2);
  EXPECT_NEAR(estimate.gain, truth.gain, 3 * estimate.gain_sd);
  EXPECT_NEAR(estimate.residual_ratio, 1, 0.2);
}

TEST(HeadMotion, FindsAnotherGainThanTheStated) {
  HeadMotionTruth truth;
  truth.gain = 0.8;
  EXPECT_EQ(identify<double>(relaxed(), 3600, truth).damping_rate_per_s.limit,
            ImpedanceLimit::mass_stated);
}

// All of the interval's width that muscles make is the share of the inertial force.
TEST(HeadMotion, MusclesWidenByTheirShare) {
  HeadMotionParameters parameters = relaxed();
  const auto of = [](const HeadMotionEstimate<double>& estimate) {
    return std::pow(estimate.damping_rate_per_s.fitted_sd, 2);
  };
  const auto without = identify<double>(parameters, 1800);
  parameters.muscle_share = 0.1;
  const auto estimate = identify<double>(parameters, 1800);
  const double expected = 0.1 * estimate.rms_acceleration_m_s2 / estimate.rms_velocity_m_s;
  EXPECT_NEAR(std::sqrt(of(estimate) - of(without)), expected, 1e-9);
}

// What an interval is widened by is what an accelerometer that is late by a standard deviation, or
// off by one of gain, does to the value.
TEST(HeadMotion, WidensByWhatAnErrorDoes) {
  constexpr double kLate_s = 0.001, kGain = 0.01;
  HeadMotionTruth late_truth, strong_truth;
  late_truth.delay_s = kLate_s;
  strong_truth.gain = 1 + kGain;
  HeadMotionParameters exact = relaxed(), said_late = relaxed(), said_strong = relaxed();
  exact.gain_sd = said_late.gain_sd = 0;
  said_late.delay_sd_s = kLate_s;
  said_strong.gain_sd = kGain;
  const auto right = identify<double>(exact, 1800);
  const auto expect = [&](const HeadMotionParameters& said, const HeadMotionTruth& truth) {
    const auto widened = identify<double>(said, 1800), wrong = identify<double>(exact, 1800, truth);
    for (const auto value : {&HeadMotionEstimate<double>::damping_rate_per_s,
                             &HeadMotionEstimate<double>::stiffness_per_mass_per_s2}) {
      const double by = std::sqrt(std::pow((widened.*value).fitted_sd, 2) -
                                  std::pow((right.*value).fitted_sd, 2)),
                   off = std::abs((wrong.*value).fitted - (right.*value).fitted);
      EXPECT_NEAR(by, off, 0.1 * off + 1e-3 * (right.*value).fitted_sd);
    }
  };
  expect(said_late, late_truth);
  expect(said_strong, strong_truth);
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
  const auto value =
      identify<double>({}, relaxed(), 1800, [](int i) { return i % 600 < 500; }).damping_rate_per_s;
  EXPECT_EQ(value.limit, ImpedanceLimit::none);
  EXPECT_LT(std::abs(value.fitted - 8), 4 * value.fitted_sd);
}

TEST(HeadMotion, ParametersAreChecked) {
  EXPECT_TRUE(is_valid(HeadMotionParameters{}));
  EXPECT_FALSE(is_valid(HeadMotionParameters{.gain_sd = -1}));
  EXPECT_FALSE(is_valid(HeadMotionParameters{.muscle_share = 1.1}));
  EXPECT_FALSE(is_valid(HeadMotionParameters{.damping_rate_per_s = {std::nan(""), 1}}));
}

// What is accepted as a prior of the identification is as one of a head motion, at any magnitude.
TEST(HeadMotion, PriorsHaveTheRangesOfTheIdentification) {
  for (double magnitude = 1e-12; magnitude < 1e12; magnitude *= 1.7) {
    for (const ImpedancePrior& prior : {ImpedancePrior{magnitude, 1}, ImpedancePrior{-magnitude, 1},
                                        ImpedancePrior{1, magnitude}, ImpedancePrior{1, -1}}) {
      ImpedanceParameters identification;
      identification.friction_Ns_m = prior;
      const bool is_prior = is_valid(identification);
      EXPECT_EQ(is_valid(HeadMotionParameters{.damping_rate_per_s = prior}), is_prior);
      EXPECT_EQ(is_valid(HeadMotionParameters{.stiffness_per_mass_per_s2 = prior}), is_prior)
          << prior.mean << ", " << prior.sd;
    }
  }
}

}  // namespace
}  // namespace condyle
