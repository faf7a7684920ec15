// SPDX-License-Identifier: Apache-2.0
// Where filters are overconfident: frozen devices, starts and steps of the motion, and a first
// guess of the noise that is far too low. What is said must hold there too.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "condyle/estimator/sensors/recommended_sensor.h"
#include "support/random.h"
#include "support/tier.h"

namespace condyle::testing_support {
namespace {

using Sensor = RecommendedSensor<double, 1>;
using Estimates = std::vector<RecommendedEstimate<double>>;

// Chewing at 1.3 Hz with its second harmonic.
double chewing_m(double t) {
  const double phase = 2 * std::numbers::pi * 1.3 * t;
  return 0.0075 * std::sin(phase) + 0.0015 * std::sin(2 * phase);
}

struct Recording {
  std::vector<Sample> samples;
  std::vector<double> truth_m;

  void add(double t, double truth, double measured) {
    Sample sample;
    sample.time_ns = nanoseconds(t);
    sample.coordinates[0] = measured;
    samples.push_back(sample);
    truth_m.push_back(truth);
  }
};

Estimates run(const Recording& recording, double rate_Hz, int lag) {
  Sensor sensor({}, lag);
  SampleChecker checker(nanoseconds(1 / rate_Hz));
  Estimates estimates;
  for (const Sample& sample : recording.samples) {
    const auto estimate = sensor.process(sample, checker.check(sample));
    if (estimate.is_ready) estimates.push_back(estimate);
  }
  RecommendedEstimate<double> waiting;
  while (sensor.drain(waiting)) estimates.push_back(waiting);
  return estimates;
}

// Share of the intervals of 95 % that hold the truth, among the positions that are not assumed.
class Coverage {
 public:
  void add(const RecommendedEstimate<double>& estimate, double truth_m) {
    const auto& position = estimate.axes[0].position_m;
    if (!std::isfinite(position.value) || position.provenance == Provenance::assumed) return;
    ++count_;
    held_ += std::abs(position.value - truth_m) <= 1.96 * position.standard_deviation ? 1 : 0;
  }
  double share() const { return held_ / count_; }
  double count() const { return count_; }

 private:
  double count_ = 0, held_ = 0;
};

class Transients : public testing::TestWithParam<int> {
 protected:
  double rate_Hz() const { return GetParam(); }
};

INSTANTIATE_TEST_SUITE_P(Rates, Transients, testing::Values(60, 200));

// The position freezes for half a second, and no event marks it: 25 times, in release 200 times.
// The intervals of one freeze hold or fail together. If they hold with probability 0.95, the share
// of 25 freezes is below 0.8 with probability 0.001.
TEST_P(Transients, WhatIsSaidOfAFrozenStretchHolds) {
  const unsigned seeds = runs(25U, 25U, 200U);
  for (const int lag : {0, 10}) {
    Coverage coverage;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      Random random(seed);
      Recording recording;
      const auto start = static_cast<std::size_t>(rate_Hz() * (12 + random.uniform()));
      const auto end = start + static_cast<std::size_t>(rate_Hz() / 2);
      for (std::size_t i = 0; i < end + 20; ++i) {
        const double t = static_cast<double>(i) / rate_Hz();
        const double measured = chewing_m(t) + 5e-5 * random.normal();
        const bool is_frozen = i >= start && i < end;
        recording.add(t, chewing_m(t),
                      is_frozen ? recording.samples.back().coordinates[0] : measured);
      }
      const Estimates estimates = run(recording, rate_Hz(), lag);
      for (std::size_t i = start; i < end; ++i) {
        EXPECT_NE(estimates[i].axes[0].position_m.provenance, Provenance::measured);
        EXPECT_TRUE(estimates[i].events.has(i < start + 3 ? Event::position_repeated
                                                          : Event::position_frozen));
        coverage.add(estimates[i], recording.truth_m[i]);
      }
    }
    EXPECT_GE(coverage.share(), 0.8) << "lag " << lag;
    EXPECT_GT(coverage.count(), seeds * 12);
  }
}

// A device that rounds repeats itself at rest, so that some repeats are taken before they are known
// for a freeze. What they led to is not shown where there is time to take it back.
TEST_P(Transients, WhatAFreezeLedToIsTakenBack) {
  Recording recording;
  Random random(7);
  const auto rounded = [&](double position) {
    return 1e-5 * std::round((position + 4e-6 * random.normal()) / 1e-5);
  };
  const auto rest = static_cast<std::size_t>(20 * rate_Hz());
  const auto start = rest + static_cast<std::size_t>(0.3 * rate_Hz());
  for (std::size_t i = 0; i < start + 120; ++i) {
    const double t = static_cast<double>(i) / rate_Hz();
    const double truth = i < rest ? 0 : 0.08 * (t - 20);
    recording.add(t, truth, i < start ? rounded(truth) : recording.samples.back().coordinates[0]);
  }
  const int lag = 16;
  const Estimates estimates = run(recording, rate_Hz(), lag);
  std::size_t noticed = start;
  while (!run(recording, rate_Hz(), 0)[noticed].events.has(Event::position_frozen)) ++noticed;
  EXPECT_GT(noticed, start + 3) << "some repeats were taken";
  ASSERT_LT(noticed, start + 60);
  for (std::size_t i = std::max(start, noticed - lag); i < start + 120; ++i) {
    EXPECT_TRUE(estimates[i].events.has(Event::position_frozen)) << i;
    EXPECT_FALSE(std::isfinite(estimates[i].axes[0].position_m.value)) << i;
  }
}

TEST_P(Transients, RowsSentTwiceChangeNothing) {
  Recording once, twice;
  Random random(3);
  for (std::size_t i = 0; i < 1200; ++i) {
    const double t = static_cast<double>(i) / rate_Hz();
    const double measured = i >= 700 && i < 800 ? once.samples.back().coordinates[0]
                                                : chewing_m(t) + 5e-5 * random.normal();
    once.add(t, 0, measured);
    for (int copy = 0; copy < 2; ++copy) twice.add(t, 0, measured);
  }
  const Estimates single = run(once, rate_Hz(), 0), doubled = run(twice, rate_Hz(), 0);
  for (std::size_t i = 0; i < single.size(); ++i) {
    const auto& expected = single[i].axes[0].velocity_m_s;
    const auto& actual = doubled[2 * i].axes[0].velocity_m_s;
    EXPECT_EQ(std::isfinite(actual.value), std::isfinite(expected.value)) << i;
    if (!std::isfinite(expected.value)) continue;
    ASSERT_EQ(actual.value, expected.value) << i;
  }
}

// The jaw rests, then moves at once at 80 mm/s; or what is followed jumps by 5 mm. The filter that
// takes over must not take the instrument for a better one. 30 runs of 55 samples (200 in release),
// which depend on each other: the probability of a false alarm is not known.
TEST_P(Transients, PositionsHoldAfterAStartAndAStep) {
  const auto start = [](double t) {
    return t < 15 ? 0.0 : 0.01 * std::sin(2 * std::numbers::pi * 1.3 * (t - 15));
  };
  const unsigned seeds = runs(30U, 30U, 200U);
  const auto step = [](double t) { return chewing_m(t) + (t < 15 ? 0 : 0.005); };
  for (double (*const truth)(double) : {+start, +step}) {
    Coverage coverage;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      Random random(seed);
      Recording recording;
      const auto change = static_cast<std::size_t>(15 * rate_Hz());
      for (std::size_t i = 0; i < change + 60; ++i) {
        const double t = static_cast<double>(i) / rate_Hz();
        recording.add(t, truth(t), truth(t) + 5e-5 * random.normal());
      }
      const Estimates estimates = run(recording, rate_Hz(), 0);
      for (std::size_t i = change + 5; i < change + 60; ++i) {
        coverage.add(estimates[i], recording.truth_m[i]);
      }
    }
    EXPECT_GT(coverage.share(), 0.9);
    EXPECT_EQ(coverage.count(), seeds * 55);
  }
}

// Noise up to 80 times the guess: what is called measured has intervals that hold, from the first
// sample that is. Errors of one run depend on each other: the probability of a false alarm is not
// known.
TEST_P(Transients, NothingIsMeasuredBeforeTheNoiseIsKnown) {
  const unsigned seeds = runs(60U, 60U, 200U);
  for (const double noise_m : {5e-5, 3e-4, 1e-3, 4e-3}) {
    Coverage coverage;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      Random random(seed);
      Recording recording;
      const double phase = random.uniform();
      for (std::size_t i = 0; i < 60; ++i) {
        const double t = static_cast<double>(i) / rate_Hz();
        recording.add(t, chewing_m(t + phase), chewing_m(t + phase) + noise_m * random.normal());
      }
      const Estimates estimates = run(recording, rate_Hz(), 0);
      for (std::size_t i = 0; i < 60; ++i) coverage.add(estimates[i], recording.truth_m[i]);
    }
    EXPECT_GT(coverage.share(), 0.85) << noise_m;
    EXPECT_GT(coverage.count(), seeds * 15) << noise_m << ": it is known in the end";
  }
}

}  // namespace
}  // namespace condyle::testing_support
