// SPDX-License-Identifier: Apache-2.0
// The envelope of raw EMG: as large as the EMG is, whatever else comes with it.
#include "condyle/estimator/emg/emg_envelope.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace condyle {
namespace {

constexpr double kMeanOfSize = 0.7978845608028654;  // of normal numbers of variance 1

// EMG as it is modelled: noise whose standard deviation is modulated.
class RawEmg {
 public:
  double amplitude_at(double time_s) const {
    return 0.5 + 0.3 * std::sin(2 * std::numbers::pi * time_s);
  }
  double next(double time_s) { return amplitude_at(time_s) * normal_(random_); }

 private:
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};

template <class Scalar>
void expect_amplitude(double offset, double artefact) {
  EnvelopeParameters parameters;
  parameters.maximum = kMeanOfSize;
  parameters.rate_Hz = 2000;
  EmgEnvelope<Scalar> envelope(parameters);
  RawEmg emg;
  const double delay_s = EmgEnvelope<Scalar>::delay_s(parameters);
  double error = 0, size = 0, bias = 0, count = 0;
  for (int i = 0; i < 60000; ++i) {
    const double time_s = i / 2000.0;
    const double x =
        emg.next(time_s) + offset + artefact * std::sin(2 * std::numbers::pi * 1.3 * time_s);
    const auto estimate = envelope.add(static_cast<Scalar>(x));
    EXPECT_EQ(estimate.is_valid, time_s > 0.25 - 1e-3);
    if (!estimate.is_valid) continue;
    // The high-pass keeps all but 2 % of white noise up to 1000 Hz.
    const double truth = std::sqrt(0.978) * emg.amplitude_at(time_s - delay_s);
    error += std::pow(static_cast<double>(estimate.excitation) - truth, 2);
    bias += static_cast<double>(estimate.excitation) - truth;
    size += truth * truth;
    ++count;
  }
  // 6 Hz of 1000 Hz of noise: about sqrt(0.57 * 2 * 1.11 * 6 / 2000) of the amplitude is chance.
  EXPECT_LT(std::sqrt(error / size), 0.09);
  EXPECT_NEAR(bias / count, 0, 0.01);
}

TEST(EmgEnvelope, IsTheAmplitudeOfTheNoise) {
  expect_amplitude<double>(0, 0);
  expect_amplitude<float>(0, 0);
}

TEST(EmgEnvelope, DoesNotSeeOffsetAndMotionArtefact) {
  expect_amplitude<double>(10, 1);
  expect_amplitude<float>(10, 1);
}

// Butterworth: -3 dB at the cutoff, whatever the rate. The second harmonic of a rectified sine is
// below 2 % after the low-pass.
TEST(EmgEnvelope, IsHalvedInPowerAtTheHighPass) {
  for (const double rate_Hz : {500.0, 1000.0, 4000.0}) {
    for (const double frequency_Hz : {20.0, 100.0}) {
      EnvelopeParameters parameters;
      parameters.rate_Hz = rate_Hz;
      parameters.low_pass_Hz = 2;
      EmgEnvelope<double> envelope(parameters);
      double last = 0;
      for (int i = 0; i < 5 * static_cast<int>(rate_Hz); ++i) {
        last = envelope.add(std::sin(2 * std::numbers::pi * frequency_Hz * i / rate_Hz)).envelope;
      }
      const double gain = frequency_Hz == 20.0 ? std::sqrt(0.5) : 1;
      EXPECT_NEAR(last, gain * 2 / std::numbers::pi, 0.02) << rate_Hz << ' ' << frequency_Hz;
    }
  }
}

TEST(EmgEnvelope, CountsWhatItDoesNotTake) {
  EnvelopeParameters parameters;
  parameters.saturation = 5;
  parameters.maximum = 0.1;
  EmgEnvelope<double> clean(parameters), broken(parameters);
  std::mt19937_64 random{2};
  std::normal_distribution<double> normal;
  double worst = 0;
  for (int i = 0; i < 5000; ++i) {
    const double x = normal(random);
    const double expected = clean.add(x).envelope;
    double given = x;
    if (i % 100 == 50) given = std::numeric_limits<double>::quiet_NaN();
    if (i % 100 == 60) given = -std::numeric_limits<double>::infinity();
    if (i % 100 == 70) given = i % 200 == 70 ? 5 : -7;
    const auto estimate = broken.add(given);
    ASSERT_TRUE(std::isfinite(estimate.envelope));
    if (estimate.is_valid) worst = std::max(worst, std::abs(estimate.envelope - expected));
  }
  EXPECT_LT(worst, 0.2) << "3 % of the samples are missing";
  EXPECT_EQ(broken.counts().not_finite, 100U);
  EXPECT_EQ(broken.counts().saturated, 50U);
  EXPECT_EQ(broken.counts().restarts, 0U);
  EXPECT_GT(broken.counts().above_maximum, 4000U);
}

TEST(EmgEnvelope, StartsAnewAfterALongHold) {
  EnvelopeParameters parameters;
  parameters.longest_hold_s = 0.0995;
  EmgEnvelope<double> envelope(parameters);
  for (int i = 0; i < 1000; ++i) (void)envelope.add(i % 2 == 0 ? 1 : -1);
  EXPECT_NEAR(envelope.add(1).envelope, 1, 0.01);
  EnvelopeEstimate<double> estimate;
  for (int i = 0; i < 200; ++i) {
    estimate = envelope.add(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(estimate.is_valid, i < 99) << i;
  }
  EXPECT_EQ(envelope.counts().restarts, 1U);
  for (int i = 0; i < 200; ++i) EXPECT_FALSE(envelope.add(100).is_valid);
  EXPECT_EQ(envelope.add(100).envelope, 0) << "a constant is no EMG, however large";
}

TEST(EmgEnvelope, RestsWhereTheFirstSampleIs) {
  EmgEnvelope<double> envelope({});
  for (int i = 0; i < 200; ++i) ASSERT_NEAR(envelope.add(100).envelope, 0, 1e-9) << i;
}

RC_GTEST_PROP(EmgEnvelope, ScalesWithTheEmg, ()) {
  const double factor = *rc::gen::map(rc::gen::inRange(1, 1000), [](int n) { return n / 32.0; });
  EmgEnvelope<double> one({}), scaled({});
  std::mt19937_64 random{3};
  std::normal_distribution<double> normal;
  for (int i = 0; i < 500; ++i) {
    const double x = normal(random);
    const double y = one.add(x).envelope;
    RC_ASSERT(std::abs(scaled.add(factor * x).envelope - factor * y) <= 1e-12 * factor);
    RC_ASSERT(y >= 0);
  }
}

TEST(EmgEnvelope, RefusesFiltersThatCannotBe) {
  EXPECT_TRUE(is_valid(EnvelopeParameters{}));
  EnvelopeParameters slow, flat;
  slow.rate_Hz = 40;
  flat.maximum = 0;
  EXPECT_FALSE(is_valid(slow));
  EXPECT_FALSE(is_valid(flat));
}

}  // namespace
}  // namespace condyle
