// SPDX-License-Identifier: Apache-2.0
// The recommended estimator with corrections learned from the recording itself.
#include "condyle/estimator/sensors/learned_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "condyle/estimator/sensors/recommended_sensor.h"
#include "support/random.h"

namespace condyle {
namespace {

using testing_support::Random;

constexpr TimeNs kStep_ns = 16'666'667;
constexpr double kAngular_rad_s = 8;

template <class Scalar>
using Plain = RecommendedSensor<Scalar, 1>;
template <class Scalar>
using Learned = LearnedSensor<Plain<Scalar>, Scalar, 1, 16, 96>;

double position_m(double t) {
  return 0.007 * std::sin(kAngular_rad_s * t) + 0.002 * std::sin(2 * kAngular_rad_s * t);
}
double velocity_m_s(double t) {
  return kAngular_rad_s *
         (0.007 * std::cos(kAngular_rad_s * t) + 0.004 * std::cos(2 * kAngular_rad_s * t));
}

double acceleration_m_s2(double t) {
  return -kAngular_rad_s * kAngular_rad_s *
         (0.007 * std::sin(kAngular_rad_s * t) + 0.008 * std::sin(2 * kAngular_rad_s * t));
}

DrivenParameters with_kernels(double kernels) {
  DrivenParameters parameters;
  parameters.learning.kernels = kernels;
  return parameters;
}

Sample sample_at(TimeNs time_ns, double measured_m, bool is_measured = true) {
  Sample sample;
  sample.time_ns = time_ns;
  sample.kind = SampleKind::one_axis;
  sample.coordinates[0] = measured_m;
  sample.position_valid = is_measured;
  return sample;
}

template <class Scalar>
bool same_bits(const Quantity<Scalar>& a, const Quantity<Scalar>& b) {
  return std::memcmp(&a.value, &b.value, sizeof a.value) == 0 &&
         std::memcmp(&a.standard_deviation, &b.standard_deviation, sizeof a.value) == 0 &&
         a.provenance == b.provenance;
}

template <class Scalar>
bool same_motion(const AxisEstimate<Scalar>& a, const AxisEstimate<Scalar>& b) {
  return same_bits(a.position_m, b.position_m) && same_bits(a.velocity_m_s, b.velocity_m_s) &&
         same_bits(a.acceleration_m_s2, b.acceleration_m_s2) && same_bits(a.force_N, b.force_N);
}

// With lost samples, glitches and a gap.
Sample disturbed_sample(TimeNs i, Random& random) {
  const TimeNs time_ns = i * kStep_ns + (i >= 1200 ? 700'000'000 : 0);
  const double glitch_m = i % 97 == 41 ? 0.01 : 0;
  return sample_at(time_ns, position_m(seconds(time_ns)) + glitch_m + 1e-4 * random.normal(),
                   i % 31 != 9);
}

template <class Scalar>
void expect_plain_without_kernels() {
  const auto plain = std::make_unique<Plain<Scalar>>(with_kernels(0));
  const auto learned = std::make_unique<Learned<Scalar>>(with_kernels(0));
  EXPECT_FALSE(learned->learns());
  Random random(1);
  for (TimeNs i = 0; i < 1500; ++i) {
    const Sample sample = disturbed_sample(i, random);
    const auto a = plain->process(sample, {}), b = learned->process(sample, {});
    ASSERT_TRUE(same_motion(a.axes[0], b.axes[0])) << i;
    EXPECT_EQ(b.axes[0].velocity_learned, Scalar(0));
  }
}

TEST(LearnedSensor, WithoutKernelsTheEstimatesAreThoseOfTheSensor) {
  expect_plain_without_kernels<double>();
  expect_plain_without_kernels<float>();
}

// At 60 Hz the teacher is three samples late: with more lag nothing is left to correct.
TEST(LearnedSensor, WithTheTeachersLagTheEstimatesAreThoseOfTheSensor) {
  for (const int lag : {3, 8, 16}) {
    const auto plain = std::make_unique<Plain<double>>(with_kernels(96), lag);
    const auto learned = std::make_unique<Learned<double>>(with_kernels(96), lag);
    EXPECT_EQ(learned->learns(), lag < 16);
    Random random(1);
    for (TimeNs i = 0; i < 1500; ++i) {
      const Sample sample = disturbed_sample(i, random);
      const auto a = plain->process(sample, {}), b = learned->process(sample, {});
      ASSERT_EQ(a.is_ready, b.is_ready);
      ASSERT_TRUE(same_motion(a.axes[0], b.axes[0])) << lag << ", " << i;
      EXPECT_EQ(b.axes[0].velocity_learned, 0);
    }
  }
}

// Where nothing is corrected, value and interval are the sensor's, and the position always is.
TEST(LearnedSensor, WhatIsNotCorrectedStays) {
  const auto plain = std::make_unique<Plain<double>>(with_kernels(96));
  const auto learned = std::make_unique<Learned<double>>(with_kernels(96));
  Random random(2);
  int corrected = 0;
  for (TimeNs i = 0; i < 1500; ++i) {
    const Sample sample = disturbed_sample(i, random);
    const auto a = plain->process(sample, {}).axes[0], b = learned->process(sample, {}).axes[0];
    ASSERT_TRUE(same_bits(a.position_m, b.position_m)) << i;
    if (b.velocity_learned == 0) {
      ASSERT_TRUE(same_bits(a.velocity_m_s, b.velocity_m_s)) << i;
    } else {
      ++corrected;
    }
    if (b.acceleration_learned == 0) {
      ASSERT_TRUE(same_bits(a.force_N, b.force_N)) << i;
    }
    // The first seconds, and the first after the gap, from which no teacher comes.
    if (i < 60 || (i >= 1200 && i < 1203)) {
      EXPECT_EQ(b.velocity_learned, 0) << i;
    }
  }
  EXPECT_GT(corrected, 1000);
}

// A jump, as at an impact, is not what was learned.
TEST(LearnedSensor, IsSilentAtASurprise) {
  const auto learned = std::make_unique<Learned<double>>(with_kernels(96));
  Random random(7);
  int corrected_before = 0;
  for (TimeNs i = 0; i < 1204; ++i) {
    const double jump_m = i >= 1200 ? 1.5e-3 * static_cast<double>(i - 1199) : 0;
    const double measured_m = position_m(seconds(i * kStep_ns)) + jump_m + 1e-4 * random.normal();
    const auto axis = learned->process(sample_at(i * kStep_ns, measured_m), {}).axes[0];
    if (i >= 1100 && i < 1200) corrected_before += axis.velocity_learned > 0 ? 1 : 0;
    if (i >= 1200) {
      EXPECT_EQ(axis.velocity_learned, 0) << i;
    }
  }
  EXPECT_GT(corrected_before, 80);
}

struct Errors {
  double plain = 0, learned = 0, held = 0, plain_held = 0, samples = 0;
};

// Of the velocity, after 12 s.
template <class Scalar>
Errors errors_of(std::uint64_t seed, int lag = 0) {
  const auto plain = std::make_unique<Plain<Scalar>>(with_kernels(96), lag);
  const auto learned = std::make_unique<Learned<Scalar>>(with_kernels(96), lag);
  Random random(seed);
  Errors errors;
  for (TimeNs i = 0; i < 2400; ++i) {
    const double t = seconds(i * kStep_ns);
    const Sample sample = sample_at(i * kStep_ns, position_m(t) + 1e-4 * random.normal());
    const auto a = plain->process(sample, {}).axes[0].velocity_m_s;
    const auto b = learned->process(sample, {}).axes[0].velocity_m_s;
    if (i < 720) continue;
    const double truth = velocity_m_s(seconds((i - lag) * kStep_ns));
    const double of_plain = static_cast<double>(a.value) - truth;
    const double of_learned = static_cast<double>(b.value) - truth;
    errors.plain += of_plain * of_plain;
    errors.learned += of_learned * of_learned;
    errors.held +=
        std::abs(of_learned) < kNormalQuantile95 * static_cast<double>(b.standard_deviation);
    ++errors.samples;
  }
  const LearningCounts& counts = learned->learning(0);
  EXPECT_GT(counts.corrected, 9 * counts.samples / 10);
  if (lag == 0) {
    EXPECT_LT(counts.error_ratio(), 0.9);
  }
  return errors;
}

TEST(LearnedSensor, HalvesTheErrorOfARegularMotion) {
  for (const std::uint64_t seed : {3U, 4U, 5U}) {
    const Errors errors = errors_of<double>(seed);
    EXPECT_LT(std::sqrt(errors.learned / errors.plain), 0.5) << seed;
    EXPECT_GT(errors.held / errors.samples, 0.95) << seed;
  }
}

// A sample later, half of what the teacher knows is already known.
TEST(LearnedSensor, CorrectsALagBelowTheTeachers) {
  for (const std::uint64_t seed : {3U, 4U, 5U}) {
    const Errors errors = errors_of<double>(seed, 1);
    EXPECT_LT(std::sqrt(errors.learned / errors.plain), 0.95) << seed;
    EXPECT_GT(errors.held / errors.samples, 0.95) << seed;
  }
}

TEST(LearnedSensor, FloatGivesWhatDoubleDoes) {
  const Errors in_double = errors_of<double>(3), in_float = errors_of<float>(3);
  EXPECT_NEAR(std::sqrt(in_float.learned / in_double.learned), 1, 0.02);
}

// Begins `to` with what `from` has learned.
template <class Scalar>
void hand_over(Learned<Scalar>& from, Learned<Scalar>& to) {
  std::vector<std::vector<Scalar>> values;
  from.corrector(0).visit_learned([&values](const char*, const Scalar* first, int count) {
    values.emplace_back(first, first + count);
  });
  to.corrector(0).begin_with(from.corrector(0).kernels());
  std::size_t next = 0;
  to.corrector(0).visit_learned([&](const char* name, Scalar* first, int count) {
    ASSERT_EQ(values[next].size(), static_cast<std::size_t>(count)) << name;
    std::copy(values[next].begin(), values[next].end(), first);
    ++next;
  });
}

// Sum of squares of the velocity errors from 1.2 s to 4 s of the motion `slowed` times as slow;
// nothing is corrected in the first 60 samples.
double early_error(Learned<double>& sensor, double slowed, std::uint64_t seed) {
  Random random(seed);
  double sum = 0;
  for (TimeNs i = 0; i < 240; ++i) {
    const double t = seconds(i * kStep_ns) / slowed + 0.3;
    const auto axis =
        sensor.process(sample_at(i * kStep_ns, position_m(t) + 1e-4 * random.normal()), {}).axes[0];
    if (i < 60) {
      EXPECT_EQ(axis.velocity_learned, 0);
    }
    if (i >= 72) sum += std::pow(axis.velocity_m_s.value - velocity_m_s(t) / slowed, 2);
  }
  return sum;
}

TEST(LearnedSensor, BeginsWithWhatAnEarlierRecordingTaught) {
  const auto earlier = std::make_unique<Learned<double>>(with_kernels(96));
  Random random(21);
  for (TimeNs i = 0; i < 1800; ++i) {
    const double measured_m = position_m(seconds(i * kStep_ns)) + 1e-4 * random.normal();
    earlier->process(sample_at(i * kStep_ns, measured_m), {});
  }
  // A regular motion is learned as soon; of another, little is lost. The command's test shows the
  // gain where cycles vary.
  for (const double slowed : {1.0, 2.5}) {
    double with = 0, without = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const auto fresh = std::make_unique<Learned<double>>(with_kernels(96));
      const auto taught = std::make_unique<Learned<double>>(with_kernels(96));
      hand_over(*earlier, *taught);
      without += early_error(*fresh, slowed, seed);
      with += early_error(*taught, slowed, seed);
    }
    EXPECT_LT(std::sqrt(with / without), 1.05) << slowed;
  }
}

// What an instrument may do to positions with noise, before they are measured.
enum class Instrument { plain, smooths, delays, delays_before_noise };

// Errors of velocity (0) and acceleration (1) of a jaw that an `instrument` measures at 60 Hz.
struct Compared {
  Errors of[2];
};

Compared compare(Instrument instrument, std::uint64_t seed) {
  const auto plain = std::make_unique<Plain<double>>(with_kernels(96));
  const auto learned = std::make_unique<Learned<double>>(with_kernels(96));
  Random random(seed);
  Compared compared;
  double smoothed_m = 0, slow_m = 0;
  for (TimeNs i = 0; i < 1800; ++i) {
    const double t = seconds(i * kStep_ns), noise_m = 1e-4 * random.normal();
    smoothed_m += 0.6 * (position_m(t) + noise_m - smoothed_m);
    slow_m += 0.4 * (position_m(t) - slow_m);
    const double measured_m = instrument == Instrument::plain     ? position_m(t) + noise_m
                              : instrument == Instrument::smooths ? smoothed_m
                              : instrument == Instrument::delays  ? position_m(t - 0.01) + noise_m
                                                                  : slow_m + noise_m;
    const auto a = plain->process(sample_at(i * kStep_ns, measured_m), {}).axes[0];
    const auto b = learned->process(sample_at(i * kStep_ns, measured_m), {}).axes[0];
    // Nothing narrows an interval.
    EXPECT_GE(b.velocity_m_s.standard_deviation, a.velocity_m_s.standard_deviation) << i;
    EXPECT_GE(b.acceleration_m_s2.standard_deviation, a.acceleration_m_s2.standard_deviation) << i;
    if (i < 300) continue;
    const double truth[2] = {velocity_m_s(t), acceleration_m_s2(t)};
    const Quantity<double> of_plain[2] = {a.velocity_m_s, a.acceleration_m_s2};
    const Quantity<double> of_learned[2] = {b.velocity_m_s, b.acceleration_m_s2};
    for (int k = 0; k < 2; ++k) {
      Errors& errors = compared.of[k];
      const auto holds = [&](const Quantity<double>& said) {
        return std::abs(said.value - truth[k]) < kNormalQuantile95 * said.standard_deviation;
      };
      errors.plain += std::pow(of_plain[k].value - truth[k], 2);
      errors.learned += std::pow(of_learned[k].value - truth[k], 2);
      errors.held += holds(of_learned[k]);
      errors.plain_held += holds(of_plain[k]);
      ++errors.samples;
    }
  }
  return compared;
}

// Positions need not show that an instrument smooths or delays them. The filter's intervals are
// then wrong, and learning must not make them worse. Over 1500 samples the shares that hold vary by
// far less than the bound: both filters have the same samples.
TEST(LearnedSensor, IsNoWorseThanTheFilterWithAnyInstrument) {
  for (const Instrument instrument : {Instrument::plain, Instrument::smooths, Instrument::delays,
                                      Instrument::delays_before_noise}) {
    for (const std::uint64_t seed : {11U, 12U, 13U}) {
      const Compared compared = compare(instrument, seed);
      for (const Errors& errors : compared.of) {
        EXPECT_LT(errors.learned, 1.02 * errors.plain) << static_cast<int>(instrument);
        EXPECT_GE(errors.held, errors.plain_held - 0.01 * errors.samples)
            << static_cast<int>(instrument);
      }
    }
  }
}

// Means of three positions: the teacher is as wrong as the filter.
TEST(LearnedSensor, IsSilentWhileTheNoiseIsNotWhite) {
  const auto learned = std::make_unique<Learned<double>>(with_kernels(96));
  Random random(6);
  double before_m = 0, last_m = 0;
  for (TimeNs i = 0; i < 1800; ++i) {
    const double raw_m = position_m(seconds(i * kStep_ns)) + 1e-4 * random.normal();
    const double smoothed_m = (before_m + last_m + raw_m) / 3;
    before_m = last_m;
    last_m = raw_m;
    const auto axis = learned->process(sample_at(i * kStep_ns, smoothed_m), {}).axes[0];
    if (i >= 600) {
      EXPECT_EQ(axis.velocity_learned, 0) << i;
    }
  }
}

TEST(VelocityHistory, IsAStraightLineBetweenItsEntries) {
  VelocityHistory<double> history;
  EXPECT_EQ(history.at(0, 100), 0);
  const TimeNs first_ns = std::numeric_limits<TimeNs>::max() - 2'000'000'000;
  for (TimeNs i = 0; i <= 100; ++i) {
    history.add(first_ns + i * 10'000'000, static_cast<double>(i));
  }
  const TimeNs now_ns = first_ns + 1'000'000'000;
  EXPECT_DOUBLE_EQ(history.at(now_ns, 0), 100);
  EXPECT_DOUBLE_EQ(history.at(now_ns, 254'000'000), 74.6);
  EXPECT_DOUBLE_EQ(history.at(now_ns, 1'000'000'000), 0);
  EXPECT_EQ(history.at(now_ns, 1'000'000'001), 0);
  EXPECT_DOUBLE_EQ(history.at(now_ns + 500'000'000, 10), 100);
}

}  // namespace
}  // namespace condyle
