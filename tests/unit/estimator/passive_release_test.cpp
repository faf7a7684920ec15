// SPDX-License-Identifier: Apache-2.0
#include "condyle/estimator/release/passive_release.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/rapidcheck_gtest.h"
#include "support/release_samples.h"

namespace condyle {
namespace {

using testing_support::fit;
using testing_support::number_between;
using testing_support::release_samples;
using testing_support::ReleaseSamples;
using testing_support::ReleaseTruth;

constexpr double kNoise_m = 5e-5;

// Noise far below what is stated: the values are the truth, in every regime.
RC_GTEST_PROP(PassiveReleaseFit, FindsTheTruthWithoutNoise, ()) {
  ReleaseTruth truth;
  const double omega = *number_between(8, 40);
  const double zeta = *number_between(0, 1.8);
  truth.lambda_per_s = 2 * zeta * omega;
  truth.kappa_per_s2 = omega * omega;
  truth.rest_m = *number_between(-0.5, 0.5);
  truth.opening_m = *number_between(0.002, 0.02);
  truth.velocity_m_s = *number_between(-0.02, 0);
  const auto release = fit(release_samples(truth, 0, 1), {});
  RC_ASSERT(release.outcome == ReleaseOutcome::converged);
  RC_ASSERT(std::abs(release.rates.lambda - truth.lambda_per_s) < 1e-4 * omega);
  RC_ASSERT(std::abs(release.rates.kappa / truth.kappa_per_s2 - 1) < 1e-4);
  RC_ASSERT(std::abs(release.rest_m - truth.rest_m) < 1e-7);
}

TEST(PassiveReleaseFit, CriticalDampingIsNoSpecialCase) {
  for (const double lambda : {39.99, 40.0, 40.01}) {
    ReleaseTruth truth;
    truth.lambda_per_s = lambda;
    const auto release = fit(release_samples(truth, 0, 1), {.noise_sd_m = 1e-6, .is_sudden = true});
    ASSERT_EQ(release.outcome, ReleaseOutcome::converged);
    EXPECT_NEAR(release.damping_rate_per_s.quantity.value, lambda, 1e-3);
    EXPECT_NEAR(release.damping_ratio.quantity.value, lambda / 40, 1e-4);
    EXPECT_NEAR(release.natural_frequency_Hz.quantity.value, 20 / 6.283185307179586, 1e-4);
  }
}

TEST(PassiveReleaseFit, GivesNoValueOfAnOverdampedJawUnlessTheSupportIsGone) {
  for (const double lambda : {40.0, 60.0}) {
    ReleaseTruth truth;
    truth.lambda_per_s = lambda;
    const auto samples = release_samples(truth, kNoise_m, 1);
    const auto release = fit(samples, {.noise_sd_m = kNoise_m});
    EXPECT_EQ(release.residuals, ReleaseResiduals::overdamped) << lambda;
    EXPECT_TRUE(std::isnan(release.damping_rate_per_s.quantity.value)) << lambda;
    const auto sudden = fit(samples, {.noise_sd_m = kNoise_m, .is_sudden = true});
    EXPECT_EQ(sudden.residuals, ReleaseResiduals::as_stated) << lambda;
    EXPECT_TRUE(std::isfinite(sudden.damping_rate_per_s.quantity.value)) << lambda;
  }
}

TEST(PassiveReleaseFit, ValuesAgreeWithEachOther) {
  const auto release = fit(release_samples({}, kNoise_m, 3), {.noise_sd_m = kNoise_m});
  ASSERT_EQ(release.outcome, ReleaseOutcome::converged);
  const double omega = release.natural_frequency_rad_s.quantity.value;
  EXPECT_NEAR(release.stiffness_per_mass_per_s2.quantity.value, omega * omega, 1e-9);
  EXPECT_NEAR(release.damping_ratio.quantity.value,
              release.damping_rate_per_s.quantity.value / (2 * omega), 1e-12);
  // Here the likelihood is nearly normal: intervals are those of the covariance.
  EXPECT_NEAR(
      release.damping_rate_per_s.quantity.standard_deviation / std::sqrt(release.covariance(0, 0)),
      1, 0.03);
  EXPECT_EQ(release.damping_rate_per_s.quantity.provenance, Provenance::measured);
  EXPECT_EQ(release.residuals, ReleaseResiduals::as_stated);
}

// The noise is found where none is stated, and the user's own resolution decides what is measured.
TEST(PassiveReleaseFit, NoiseNeedNotBeKnown) {
  ReleaseTruth truth;
  truth.lambda_per_s = 24;
  const auto samples = release_samples(truth, kNoise_m, 4);
  const auto release = fit(samples, {});
  EXPECT_NEAR(release.noise_sd_m, kNoise_m, 0.4 * kNoise_m);
  EXPECT_EQ(release.damping_rate_per_s.quantity.provenance, Provenance::assumed)
      << release.damping_rate_per_s.quantity.standard_deviation;
  ReleaseSettings coarse;
  coarse.resolution.damping_rate_per_s = 8;
  EXPECT_EQ(fit(samples, coarse).damping_rate_per_s.quantity.provenance, Provenance::measured);
}

// Against the integral of the density by Simpson's rule. The first term that the expansion leaves
// out changes the share by 0.19 / degrees^4.
TEST(PassiveReleaseFit, StudentsHalfWidthHolds95Percent) {
  for (const double degrees : {5.0, 6.0, 8.0, 12.0, 20.0, 32.0, 100.0, 1000.0}) {
    const auto integral_to = [degrees](double end) {
      constexpr int kSteps = 20'000;
      double sum = 0;
      for (int i = 0; i <= kSteps; ++i) {
        const double x = end * i / kSteps;
        const double density = std::pow(std::cos(x), degrees - 1);  // of t = sqrt(degrees) tan x
        sum += (i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2) * density;
      }
      return sum * end / kSteps / 3;
    };
    const double width = internal::student_half_width(degrees);
    const double share =
        integral_to(std::atan(width / std::sqrt(degrees))) / integral_to(std::numbers::pi / 2);
    EXPECT_NEAR(share, 0.95, 0.2 / std::pow(degrees, 4) + 1e-6) << degrees;
  }
}

// Only times since the first sample count.
TEST(PassiveReleaseFit, DoesNotDependOnTheOriginOfTime) {
  const auto samples = release_samples({}, kNoise_m, 3);
  const auto expected = fit(samples, {.noise_sd_m = kNoise_m});
  EXPECT_GT(expected.later_start_s, 0);
  for (const double origin_s : {-1000.0, -0.3, 7.0, 1000.0}) {
    ReleaseSamples later = samples;
    for (double& time_s : later.time_s) time_s += origin_s;
    const auto actual = fit(later, {.noise_sd_m = kNoise_m});
    ASSERT_EQ(actual.outcome, expected.outcome);
    EXPECT_NEAR(actual.later_start_s, expected.later_start_s, 1e-9) << origin_s;
    const auto near = [](const ReleaseValue<double>& a, const ReleaseValue<double>& b) {
      EXPECT_NEAR(a.quantity.value / b.quantity.value, 1, 1e-6);
      EXPECT_NEAR(a.low95 / b.low95, 1, 1e-4);
      EXPECT_NEAR(a.high95 / b.high95, 1, 1e-4);
    };
    near(actual.damping_rate_per_s, expected.damping_rate_per_s);
    near(actual.stiffness_per_mass_per_s2, expected.stiffness_per_mass_per_s2);
    near(actual.damping_ratio, expected.damping_ratio);
    near(actual.natural_frequency_Hz, expected.natural_frequency_Hz);
  }
}

// So strongly damped that the fast part is over before the second sample: a lower end, no value.
TEST(PassiveReleaseFit, SaysSoWhereTheDampingHasNoUpperEnd) {
  ReleaseTruth truth;
  truth.lambda_per_s = 600;
  truth.kappa_per_s2 = 3000;
  const auto release = fit(release_samples(truth, kNoise_m, 1), {.noise_sd_m = kNoise_m});
  EXPECT_NE(release.damping_rate_per_s.quantity.provenance, Provenance::measured);
  EXPECT_TRUE(std::isnan(release.damping_rate_per_s.quantity.value));
  EXPECT_GE(release.damping_rate_per_s.high95, truth.lambda_per_s);
  EXPECT_LE(release.damping_rate_per_s.low95, truth.lambda_per_s);
}

// Dry friction, smoothing and a wrong noise are found out, and nothing is measured then.
TEST(PassiveReleaseFit, DistrustsWhatTheModelDoesNotExplain) {
  const auto clean = release_samples({}, kNoise_m, 5);
  const auto is_withheld = [](const PassiveRelease<double>& release) {
    return std::isnan(release.damping_rate_per_s.quantity.value) &&
           std::isnan(release.stiffness_per_mass_per_s2.quantity.value) &&
           std::isinf(release.damping_rate_per_s.high95) &&
           release.damping_rate_per_s.information == 0;
  };
  const auto stated_small = fit(clean, {.noise_sd_m = kNoise_m / 3});
  EXPECT_EQ(stated_small.residuals, ReleaseResiduals::larger);
  EXPECT_TRUE(is_withheld(stated_small));

  ReleaseSamples dry = clean;  // decays along a line, not an exponential
  for (std::size_t i = 0; i < dry.time_s.size(); ++i) {
    dry.position_m[i] = 0.01 * std::max(0.0, 1 - 2 * dry.time_s[i]) * std::cos(20 * dry.time_s[i]) +
                        clean.position_m[i] - release_samples({}, 0, 5).position_m[i];
  }
  const auto of_dry = fit(dry, {.noise_sd_m = kNoise_m});
  EXPECT_EQ(of_dry.residuals, ReleaseResiduals::larger);
  EXPECT_TRUE(is_withheld(of_dry));
  const auto of_dry_unstated = fit(dry, {});
  EXPECT_EQ(of_dry_unstated.residuals, ReleaseResiduals::coloured);
  EXPECT_TRUE(is_withheld(of_dry_unstated));

  ReleaseTruth dense;
  dense.rate_Hz = 200;
  const auto noisy = release_samples(dense, kNoise_m, 6), exact = release_samples(dense, 0, 6);
  ReleaseSamples smoothed = exact;
  for (std::size_t i = 2; i + 2 < smoothed.time_s.size(); ++i) {
    for (std::size_t k = i - 2; k <= i + 2; ++k) {
      smoothed.position_m[i] += (noisy.position_m[k] - exact.position_m[k]) / 5;
    }
  }
  const auto of_smoothed = fit(smoothed, {.noise_sd_m = kNoise_m});
  EXPECT_EQ(of_smoothed.residuals, ReleaseResiduals::coloured);
  EXPECT_TRUE(is_withheld(of_smoothed));

  const auto stated_large = fit(clean, {.noise_sd_m = 3 * kNoise_m});
  EXPECT_EQ(stated_large.residuals, ReleaseResiduals::smaller);
  EXPECT_GT(stated_large.damping_rate_per_s.quantity.standard_deviation, 0.1);
}

TEST(PassiveReleaseFit, BadInputHasItsOutcome) {
  const ReleaseSettings settings{.noise_sd_m = kNoise_m};
  const auto outcome = [&](const ReleaseSamples& samples) {
    return fit(samples, settings).outcome;
  };
  const ReleaseSamples good = release_samples({}, kNoise_m, 1);
  ReleaseSamples bad = good;
  bad.position_m[3] = std::nan("");
  EXPECT_EQ(outcome(bad), ReleaseOutcome::unusable_input);
  bad = good;
  bad.time_s[3] = INFINITY;
  EXPECT_EQ(outcome(bad), ReleaseOutcome::unusable_input);
  bad = good;
  bad.time_s.pop_back();
  EXPECT_EQ(outcome(bad), ReleaseOutcome::unusable_input);
  bad = good;
  std::swap(bad.time_s[3], bad.time_s[4]);
  EXPECT_EQ(outcome(bad), ReleaseOutcome::times_unordered);
  bad.time_s[3] = bad.time_s[4];
  EXPECT_EQ(outcome(bad), ReleaseOutcome::times_unordered);
  bad = good;
  bad.time_s.resize(9);
  bad.position_m.resize(9);
  EXPECT_EQ(outcome(bad), ReleaseOutcome::too_few_samples);
  EXPECT_EQ(outcome({}), ReleaseOutcome::too_few_samples);
  bad = good;
  for (double& position_m : bad.position_m) position_m = 0.01;
  EXPECT_EQ(outcome(bad), ReleaseOutcome::no_motion);
  EXPECT_EQ(fit(bad, {}).outcome, ReleaseOutcome::no_motion);
  ReleaseTruth still;
  still.opening_m = 0;
  for (std::uint64_t seed = 21; seed <= 40; ++seed) {  // one seed in 2000 is taken for a motion
    const auto noise = release_samples(still, kNoise_m, seed);
    EXPECT_EQ(outcome(noise), ReleaseOutcome::no_motion);
    EXPECT_EQ(fit(noise, {}).outcome, ReleaseOutcome::no_motion);
  }
  EXPECT_EQ(fit(good, {.noise_sd_m = -1}).outcome, ReleaseOutcome::unusable_input);
  EXPECT_EQ(fit(good, {.noise_sd_m = NAN}).outcome, ReleaseOutcome::unusable_input);
}

// Motions that are no release must not give a confident number.
TEST(PassiveReleaseFit, OtherMotionsAreNotMeasured) {
  for (const double stated_m : {kNoise_m, 0.0}) {
    const auto with = [stated_m](auto&& position_m) {
      ReleaseSamples samples = release_samples({}, kNoise_m, 9);
      const auto exact = release_samples({}, 0, 9);
      for (std::size_t i = 0; i < samples.time_s.size(); ++i) {
        samples.position_m[i] += position_m(samples.time_s[i]) - exact.position_m[i];
      }
      return fit(samples, {.noise_sd_m = stated_m});
    };
    for (const auto& release :
         {with([](double t) { return 0.05 * t; }),              // a ramp
          with([](double t) { return 0.1 * t * t; }),           // a parabola
          with([](double t) { return t < 0.3 ? 0.0 : 0.01; }),  // a jump
          with([](double t) { return t * t * t - 0.2 * t; }), with([](double t) {
            return 0.01 * std::exp(-10 * t) + 0.005 * std::exp(-2 * t) + 0.02 * t;
          }),
          with([](double t) { return 0.01 * std::cos(15 * t + 20 * t * t); })}) {
      EXPECT_NE(release.damping_rate_per_s.quantity.provenance, Provenance::measured)
          << static_cast<int>(release.outcome) << ' ' << release.rates.lambda << " +- "
          << release.damping_rate_per_s.quantity.standard_deviation;
    }
  }
}

TEST(PassiveReleaseFit, FloatFindsWhatDoubleFinds) {
  const auto samples = release_samples({}, kNoise_m, 2);
  const std::vector<float> times(samples.time_s.begin(), samples.time_s.end());
  const std::vector<float> positions(samples.position_m.begin(), samples.position_m.end());
  const ReleaseSettings settings{.noise_sd_m = kNoise_m};
  const auto expected = fit(samples, settings);
  const auto actual = fit_passive_release<float>(times, positions, settings);
  ASSERT_EQ(actual.outcome, ReleaseOutcome::converged);
  EXPECT_NEAR(static_cast<double>(actual.damping_rate_per_s.quantity.value),
              expected.damping_rate_per_s.quantity.value, 0.01);
  EXPECT_NEAR(static_cast<double>(actual.damping_rate_per_s.quantity.standard_deviation),
              expected.damping_rate_per_s.quantity.standard_deviation, 0.004);
}

}  // namespace
}  // namespace condyle
