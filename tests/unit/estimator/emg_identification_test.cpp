// SPDX-License-Identifier: Apache-2.0
// Friction from EMG, where everything is known: what is found, what is withheld, what goes wrong.
#include "condyle/estimator/emg/emg_identification.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "condyle/estimator/emg/emg_timeline.h"

namespace condyle {
namespace {

constexpr double kMass_kg = 0.2, kNoise_m = 5e-5;

// Two muscles of different course drive a point; their forces are linear between samples.
struct Driven {
  double friction_Ns_m = 2, stiffness_N_m = 20, offset_N = 0.1;
  double gains[2] = {1.3, 0.7};
  double noise_m = kNoise_m;
  std::mt19937_64 random{1};
  std::normal_distribution<double> normal;
  double p = 0, v = 0, time_s = 0;
  double force_N[2] = {0, 0};

  static double force_at(int muscle, double t) {
    const double w = 2 * std::numbers::pi * 1.3, slow = 0.3 * std::sin(0.7 * t);
    return muscle == 0 ? 0.5 + 0.5 * std::sin((w + 0.5) * t + slow)
                       : -0.6 + 0.4 * std::sin(w * t + 2 + 3 * slow) + 0.2 * std::sin(3 * w * t);
  }
  // The position after `T`, with noise.
  double next(double T) {
    const DrivenRates<double> rates{friction_Ns_m / kMass_kg, 1 / kMass_kg,
                                    stiffness_N_m / kMass_kg, offset_N / kMass_kg};
    const double before = gains[0] * force_N[0] + gains[1] * force_N[1];
    time_s += T;
    for (int n = 0; n < 2; ++n) force_N[n] = force_at(n, time_s);
    const double after = gains[0] * force_N[0] + gains[1] * force_N[1];
    const auto step = driven_step(rates, T, p, v, before, after);
    p = step.position[kSolution];
    v = step.velocity[kSolution];
    return p + noise_m * normal(random);
  }
};

EmgParameters known_mass() {
  EmgParameters parameters;
  parameters.mass_kg = {kMass_kg, 0.001};
  parameters.lag_sd_s = 0;
  parameters.friction_resolution_Ns_m = 2;
  parameters.gain_resolution = 1;
  return parameters;
}

template <class Scalar>
EmgEstimate<Scalar> identify(EmgIdentification<Scalar>& stage, Driven& point, int samples,
                             double rate_Hz = 200) {
  for (int i = 0; i < samples; ++i) {
    const double z = point.next(1 / rate_Hz);
    typename EmgIdentification<Scalar>::Forces F{};
    for (std::size_t n = 0; n < 2; ++n) F[n] = static_cast<Scalar>(point.force_N[n]);
    stage.drive(static_cast<Scalar>(1 / rate_Hz), F);
    (void)stage.measure(Scalar(1), static_cast<Scalar>(z), static_cast<Scalar>(kNoise_m));
  }
  return stage.estimate();
}

// With EMG that is never wrong friction, gains, stiffness and offset are found.
TEST(EmgIdentification, FindsAllFromPerfectForces) {
  EmgParameters parameters = known_mass();
  parameters.error_share = 0.02;
  Driven point;
  EmgIdentification<double> stage(parameters, 2);
  const auto estimate = identify(stage, point, 6000);
  EXPECT_NEAR(estimate.friction_Ns_m.fitted, 2, 0.05);
  EXPECT_NEAR(estimate.gain[0].fitted, 1.3, 0.05);
  EXPECT_NEAR(estimate.gain[1].fitted, 0.7, 0.05);
  EXPECT_NEAR(estimate.stiffness_N_m.fitted, 20, 0.5);
  EXPECT_NEAR(estimate.offset_N.fitted, 0.1, 0.03);
  EXPECT_EQ(estimate.friction_Ns_m.quantity.provenance, Provenance::derived);
  EXPECT_EQ(estimate.gain[0].quantity.provenance, Provenance::derived);
  EXPECT_EQ(estimate.stiffness_N_m.quantity.provenance, Provenance::derived);
  EXPECT_EQ(estimate.offset_N.quantity.provenance, Provenance::derived);
  EXPECT_LT(std::abs(estimate.friction_Ns_m.fitted - 2),
            kNormalQuantile95 * estimate.friction_Ns_m.fitted_sd);
  EXPECT_EQ(estimate.mass_kg.provenance, Provenance::assumed) << "nothing measures it";
}

// The same recording, the share of error as it is of EMG: nothing is shown that is not known.
TEST(EmgIdentification, WithholdsWhereTheForceMayBeWrong) {
  Driven point;
  EmgIdentification<double> stage(known_mass(), 2);
  const auto estimate = identify(stage, point, 6000);
  EXPECT_EQ(estimate.friction_Ns_m.limit, EmgLimit::force);
  EXPECT_EQ(estimate.friction_Ns_m.quantity.provenance, Provenance::assumed);
  EXPECT_EQ(estimate.friction_Ns_m.quantity.value, EmgParameters{}.friction_Ns_m.mean);
  EXPECT_GT(estimate.friction_Ns_m.fitted_sd, 10 * estimate.friction_Ns_m.sampling_sd);
  EXPECT_EQ(estimate.offset_N.limit, EmgLimit::scale);
  EXPECT_EQ(estimate.offset_N.quantity.provenance, Provenance::assumed);
  EXPECT_EQ(estimate.offset_N.quantity.value, EmgParameters{}.offset_N.mean);
}

// Friction is proportional to the assumed mass, and its interval says how sure that is.
TEST(EmgIdentification, ScalesWithTheAssumedMass) {
  EmgParameters parameters = known_mass(), heavy = parameters;
  parameters.error_share = heavy.error_share = 0.02;
  heavy.mass_kg = {2 * kMass_kg, 0.2};
  Driven first, second;
  EmgIdentification<double> light_stage(parameters, 2), heavy_stage(heavy, 2);
  const auto light = identify(light_stage, first, 6000);
  const auto wrong = identify(heavy_stage, second, 6000);
  EXPECT_NEAR(wrong.friction_Ns_m.fitted / light.friction_Ns_m.fitted, 2, 0.02);
  EXPECT_EQ(wrong.friction_Ns_m.limit, EmgLimit::mass);
  EXPECT_GT(wrong.friction_Ns_m.fitted_sd, 0.5 * wrong.friction_Ns_m.fitted * 0.99);
}

TEST(EmgIdentification, SaysThatTheLagLimits) {
  EmgParameters parameters = known_mass();
  parameters.error_share = 0.02;
  parameters.lag_sd_s = 0.03;
  parameters.friction_resolution_Ns_m = 0.1;
  Driven point;
  EmgIdentification<double> stage(parameters, 2);
  EXPECT_EQ(identify(stage, point, 6000).friction_Ns_m.limit, EmgLimit::lag);
}

// A force that no EMG shows is noticed where it is larger than what is taken to be wrong.
TEST(EmgIdentification, NoticesAForceBeyondTheStatedError) {
  EmgParameters parameters = known_mass();
  parameters.error_share = 0.01;
  parameters.friction_resolution_Ns_m = 100;
  Driven point;
  EmgIdentification<double> stage(parameters, 1);  // knows of the first muscle only
  EXPECT_EQ(identify(stage, point, 6000).friction_Ns_m.limit, EmgLimit::model);
}

TEST(EmgIdentification, SaysNothingAtFirst) {
  Driven point;
  EmgIdentification<double> stage(known_mass(), 2);
  EXPECT_EQ(stage.estimate().friction_Ns_m.limit, EmgLimit::no_emg);
  EXPECT_EQ(stage.measure(1, 0, kNoise_m), EmgOutcome::waits);
  const auto estimate = identify(stage, point, 100);
  EXPECT_EQ(estimate.friction_Ns_m.limit, EmgLimit::too_early);
  EXPECT_EQ(estimate.friction_Ns_m.quantity.provenance, Provenance::assumed);
}

TEST(EmgIdentification, FloatFindsWhatDoubleFinds) {
  EmgParameters parameters = known_mass();
  parameters.error_share = 0.05;
  Driven first, second;
  EmgIdentification<double> in_double(parameters, 2);
  EmgIdentification<float> in_float(parameters, 2);
  const auto expected = identify(in_double, first, 4000);
  const auto actual = identify(in_float, second, 4000);
  EXPECT_NEAR(actual.friction_Ns_m.fitted, expected.friction_Ns_m.fitted, 0.1);
  EXPECT_NEAR(actual.friction_Ns_m.fitted_sd, expected.friction_Ns_m.fitted_sd,
              0.02 * expected.friction_Ns_m.fitted_sd);
}

// Whatever comes, no value is NaN, and a new start is counted.
TEST(EmgIdentification, StartsAnewRatherThanGiveNonsense) {
  Driven point;
  EmgIdentification<double> stage(known_mass(), 2);
  (void)identify(stage, point, 500);
  EmgIdentification<double>::Forces huge{};
  huge.fill(1e200);
  for (int i = 0; i < 50; ++i) {
    stage.drive(0.01, huge);
    (void)stage.measure(1, 1e-3 * i, kNoise_m);
    EXPECT_TRUE(std::isfinite(stage.estimate().friction_Ns_m.fitted));
    EXPECT_NE(stage.estimate().friction_Ns_m.quantity.provenance, Provenance::derived);
  }
  EXPECT_GT(stage.estimate().restarts, 0U);
}

// Of a still point neither its place nor its stiffness is known: p = p0 (1 - kappa T^2 / 2) and
// v = -kappa T p0 vary by the products of two unknowns, which no linear part shows.
TEST(EmgIdentification, CountsWhatTwoUnknownsDoTogether) {
  constexpr double kT_s = 0.1, kKappa_sd = 50, kPlace_sd_m = 1e-3, kMeasured_m = 1.5e-3;
  EmgParameters parameters;
  parameters.mass_kg = {kMass_kg, 0};
  parameters.friction_Ns_m = parameters.offset_N = {0, 1e-9};
  parameters.gain = {1, 1e-9};
  parameters.stiffness_N_m = {0, kKappa_sd * kMass_kg};
  parameters.velocity_sd_m_s = 1e-6;
  EmgIdentification<double> stage(parameters, 1);
  stage.drive(kT_s, {});
  ASSERT_EQ(stage.measure(1, 0, kPlace_sd_m), EmgOutcome::started);
  stage.drive(kT_s, {});
  ASSERT_EQ(stage.measure(1, kMeasured_m, 1e-7), EmgOutcome::updated);
  const double half = kKappa_sd * kT_s * kT_s / 2;  // sd of kappa T^2 / 2
  const double variance = (1 + half * half) * kPlace_sd_m * kPlace_sd_m;
  EXPECT_NEAR(stage.estimate().nis * variance / (kMeasured_m * kMeasured_m), 1, 0.01);
  const double of_both = 2 * half * half / kT_s * kPlace_sd_m * kPlace_sd_m;  // of p and v
  const double velocity_m_s = of_both / variance * kMeasured_m;
  EXPECT_NEAR(stage.estimate().velocity_m_s, velocity_m_s, 0.01 * velocity_m_s);
}

TEST(EmgIdentification, KeepsWhatItKnowsThroughAnInterruption) {
  EmgParameters parameters = known_mass();
  parameters.error_share = 0.02;
  Driven point;
  EmgIdentification<double> stage(parameters, 2);
  const auto before = identify(stage, point, 6000);
  stage.interrupt();
  EXPECT_EQ(stage.estimate().friction_Ns_m.fitted, before.friction_Ns_m.fitted);
  const auto after = identify(stage, point, 1000);
  EXPECT_NEAR(after.friction_Ns_m.fitted, 2, 0.05);
}

// For one value, E / rms y; with a prior, no more than that.
TEST(CorrelatedModelError, IsTheWorstThatAnErrorCanDo) {
  CorrelatedModelError<double, 2> coherent;
  double time = 0, mean = 0;
  Eigen::Matrix2d M = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d y(std::sin(0.1 * i), std::sin(0.1 * i + 0.3));
    time += 1;
    coherent.add(y, 1 / time);
    M += y * y.transpose() / 1000;
    mean += y[0] * y[0] / 1000;
  }
  const Eigen::Vector2d wide(1e4, 1e4), first(1e4, 1e-9), narrow(0.01, 0.01);
  EXPECT_NEAR(coherent.variances(0.09, wide)[0], 0.09 * M.inverse()(0, 0), 1e-5);
  EXPECT_NEAR(coherent.variances(0.09, first)[0], 0.09 / mean, 1e-6);
  EXPECT_LT(coherent.variances(0.09, narrow)[0], 1e-4);
  EXPECT_EQ(coherent.variances(0, narrow)[0], 1e-4) << "of nothing, nothing";
}

// The timeline: nothing that is not finite gets through, and it is counted.
TEST(EmgTimeline, CountsWhatItDoesNotTake) {
  MuscleSet muscles;
  muscles.count = 3;
  EmgTimeline<double> timeline(EmgParameters{}, muscles);
  EmgTimeline<double>::Excitations quiet{0.01, 0.01, 0.01}, broken = quiet;
  broken[1] = std::nan("");
  const auto ms = [](int n) { return TimeNs{n} * 1'000'000; };
  timeline.add_position(ms(-5), -0.001, kNoise_m);
  for (int i = 0; i < 300; ++i) {
    timeline.add_emg(ms(5 * i), i % 10 == 3 ? broken : quiet);
    if (i % 3 == 0) timeline.add_position(ms(5 * i + 1), -0.001, kNoise_m);
  }
  timeline.add_emg(ms(1000), quiet);  // back
  timeline.add_emg(ms(1494), quiet);  // not in order
  timeline.add_emg(ms(3000), quiet);
  timeline.add_position(ms(3000), 0.5, kNoise_m);
  timeline.add_position(ms(3000), std::nan(""), kNoise_m);
  const EmgTimelineCounts& counts = timeline.counts();
  EXPECT_EQ(counts.emg_not_finite, 30U);
  EXPECT_EQ(counts.emg_gaps, 3U) << "back, on again, and on";
  EXPECT_EQ(counts.emg_not_in_order, 0U);
  EXPECT_EQ(counts.out_of_reach, 2U);
  EXPECT_GE(counts.positions_too_early, 1U);
  timeline.add_emg(ms(2990), quiet);
  EXPECT_EQ(counts.emg_not_in_order, 1U);
  EXPECT_TRUE(std::isfinite(timeline.estimate().friction_Ns_m.fitted));
}

}  // namespace
}  // namespace condyle
