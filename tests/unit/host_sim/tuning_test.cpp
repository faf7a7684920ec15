// SPDX-License-Identifier: Apache-2.0
// The parts of tuning: filter, search, kept samples, stand-in. Seeds are fixed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "condyle/estimator/motion/recommended_estimator.h"
#include "hosted/files/input_error.h"
#include "statistics/random.h"
#include "support/temporary_folder.h"
#include "tuning/bounded_search.h"
#include "tuning/equivalent_white_noise.h"
#include "tuning/innovation_likelihood.h"
#include "tuning/likelihood_tuning.h"
#include "tuning/starting_values.h"
#include "tuning/tuning_recording.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using testing_support::TemporaryFolder;

constexpr double kStep_s = 0.01;

// A sine of 1 Hz and 10 mm with white noise, steps that vary by a tenth.
std::vector<TuningSample> noisy_sine(std::size_t count, double noise_m) {
  RandomGenerator random(3);
  std::vector<TuningSample> samples;
  double time_s = 0;
  for (std::size_t i = 0; i < count; ++i) {
    TuningSample sample;
    if (i > 0) sample.step_s = kStep_s * (0.9 + 0.2 * random.uniform());
    time_s += sample.step_s;
    sample.position_m = 5e-3 * std::sin(6.283 * time_s) + noise_m * random.normal();
    samples.push_back(sample);
  }
  return samples;
}

TEST(NoiseFilter, WithoutCorrelationIsTheEstimatorsOwn) {
  const NoiseModel model{8e-5, 30, 0};
  const auto samples = noisy_sine(400, 1e-4);
  RecommendedParameters parameters;
  parameters.noise.adaptation = Adaptation::off;
  parameters.noise.position_sd_m = model.position_sd_m;
  parameters.noise.jerk_density_m2_s5 = model.jerk_density_m2_s5;
  parameters.outliers.huber_sd = parameters.outliers.gate_sd = 100;
  RecommendedEstimator<double, 1, 0> estimator(parameters, 0);
  std::vector<AxisEstimate<double>> expected;
  // Times in whole nanoseconds, as the estimator has them.
  auto rounded = samples;
  TimeNs time_ns = 0;
  for (TuningSample& sample : rounded) {
    const TimeNs step_ns = nanoseconds(sample.step_s);
    sample.step_s = seconds(step_ns);
    time_ns += step_ns;
    expected.push_back(estimator.step({time_ns, true, {sample.position_m}, {}}).axes[0]);
  }
  std::size_t compared = 0;
  for_each_innovation(rounded, model, parameters.prior, [&](std::size_t i, const Innovation& one) {
    const double sd_m = expected[i].innovation_sd_m;
    EXPECT_NEAR(one.innovation_m, expected[i].innovation_m, 1e-9 * sd_m) << i;
    EXPECT_NEAR(std::sqrt(one.variance_m2), sd_m, 1e-9 * sd_m) << i;
    ++compared;
  });
  EXPECT_EQ(compared, samples.size() - 1 - NoiseFilter::kSettling);
}

TEST(NoiseFilter, OfAVeryShortCorrelationIsThatOfWhiteNoise) {
  const auto samples = noisy_sine(300, 1e-4);
  std::vector<double> white, correlated;
  const auto into = [](std::vector<double>& sum) {
    return [&sum](std::size_t, const Innovation& one) { sum.push_back(one.score()); };
  };
  for_each_innovation(samples, {1e-4, 10, 0}, {}, into(white));
  for_each_innovation(samples, {1e-4, 10, kStep_s / 40}, {}, into(correlated));
  EXPECT_THAT(correlated, testing::Pointwise(testing::DoubleNear(1e-6), white));
}

// What a stretch needs after a gap of the recording is given to the prior again.
TEST(NoiseFilter, StartsAnewWithAStretchAndAfterMissingPositions) {
  auto samples = noisy_sine(200, 1e-4);
  samples[100].step_s = 0;
  samples[150].position_m = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::size_t> counted;
  for_each_innovation(samples, {1e-4, 10, 0}, {},
                      [&](std::size_t i, const Innovation&) { counted.push_back(i); });
  EXPECT_EQ(counted.size(), 200U - 2 * (1 + NoiseFilter::kSettling) - 1);
  EXPECT_THAT(counted, testing::Not(testing::Contains(150U)));
  EXPECT_THAT(counted, testing::Not(testing::Contains(100U + NoiseFilter::kSettling)));
}

RC_GTEST_PROP(StretchKeeper, KeepsWholeStretchesEvenlySpread, ()) {
  const std::size_t most = *rc::gen::inRange<std::size_t>(1024, 5000);
  const std::size_t count = *rc::gen::inRange<std::size_t>(1, 60'000);
  StretchKeeper keeper(most);
  for (std::size_t i = 0; i < count; ++i) keeper.add({i > 0 ? 1.0 : 0.0, double(i)});
  RC_ASSERT(keeper.seen() == count);
  const auto samples = keeper.take();
  RC_ASSERT(samples.size() <= most);
  // At least a quarter of what fits, unless there are no more.
  RC_ASSERT(samples.size() >= std::min(count, most / 4));
  double stride = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double gap = samples[i].position_m - samples[i - 1].position_m;
    const bool begins = i % StretchKeeper::kStretch == 0;
    if (!begins) RC_ASSERT(gap == 1);
    if (begins && stride == 0) stride = gap;
    if (begins) RC_ASSERT(gap == stride);
    RC_ASSERT((samples[i].step_s == 0) == (gap != 1));
  }
}

// Two hills; the second is higher by 1.
double two_hills(const std::vector<double>& at) {
  const auto hill = [&at](double x, double y) {
    return std::exp(-0.5 * (std::pow(at[0] - x, 2) + std::pow(at[1] - y, 2)));
  };
  return 10 * hill(-3, 0) + 11 * hill(3, 1);
}

TEST(BoundedSearch, FindsAllHillsAndSaysWhichIsHighest) {
  const SearchBounds bounds{{-6, -6}, {6, 6}};
  const auto starts = draw_starts({-2, 0}, 5, bounds, 24, 7);
  EXPECT_EQ(starts.front(), (std::vector<double>{-2, 0}));
  const SearchResult found = search(two_hills, bounds, starts, {}, {});
  ASSERT_EQ(found.optima.size(), 2U);
  EXPECT_NEAR(found.optima[0].point[0], 3, 1e-3);
  EXPECT_NEAR(found.optima[0].point[1], 1, 1e-3);
  EXPECT_NEAR(found.optima[1].point[0], -3, 1e-3);
  EXPECT_EQ(found.optima[0].reached_by + found.optima[1].reached_by, 24);
  EXPECT_GT(found.evaluations, 24U);
}

TEST(BoundedSearch, IsTheSameForEveryNumberOfThreads) {
  const SearchBounds bounds{{-6, -6}, {6, 6}};
  std::vector<SearchResult> results;
  for (const unsigned threads : {1U, 2U, 5U}) {
    MonteCarloControl control;
    control.threads = threads;
    results.push_back(
        search(two_hills, bounds, draw_starts({0, 0}, 5, bounds, 10, 1), {}, control));
  }
  for (const SearchResult& result : results) {
    ASSERT_EQ(result.optima.size(), results[0].optima.size());
    for (std::size_t i = 0; i < result.optima.size(); ++i) {
      EXPECT_EQ(result.optima[i].point, results[0].optima[i].point);
      EXPECT_EQ(result.optima[i].value, results[0].optima[i].value);
    }
    EXPECT_EQ(result.evaluations, results[0].evaluations);
  }
}

TEST(BoundedSearch, StaysWithinBoundsAndStops) {
  const SearchBounds bounds{{-6, -6}, {2, 0.5}};
  const SearchResult found =
      search(two_hills, bounds, draw_starts({1.9, 0.4}, 0.5, bounds, 4, 1), {}, {});
  EXPECT_DOUBLE_EQ(found.optima[0].point[0], 2);
  EXPECT_DOUBLE_EQ(found.optima[0].point[1], 0.5);
  MonteCarloControl control;
  control.stop = [] { return true; };
  EXPECT_TRUE(search(two_hills, bounds, draw_starts({0, 0}, 1, bounds, 4, 1), {}, control).stopped);
}

TEST(EquivalentWhiteNoise, OfNoiseThatIsNearlyWhiteIsThatNoise) {
  const NoiseModel model{1e-4, 5, kStep_s / 20};
  const EquivalentWhiteNoise stand_in = equivalent_white_noise(model, kStep_s);
  EXPECT_NEAR(stand_in.white.position_sd_m / model.position_sd_m, 1, 0.01);
  EXPECT_NEAR(stand_in.white.jerk_density_m2_s5 / model.jerk_density_m2_s5, 1, 0.02);
  EXPECT_NEAR(stand_in.velocity_error_m_s / stand_in.best_velocity_error_m_s, 1, 1e-4);
}

TEST(EquivalentWhiteNoise, ErrsMoreThanTheFilterThatKnowsTheNoise) {
  for (const double correlation_s : {0.01, 0.03, 0.1}) {
    const EquivalentWhiteNoise stand_in = equivalent_white_noise({1e-4, 5, correlation_s}, kStep_s);
    EXPECT_GT(stand_in.velocity_error_m_s, stand_in.best_velocity_error_m_s);
    EXPECT_LT(stand_in.velocity_error_m_s, 2 * stand_in.best_velocity_error_m_s);
  }
}

TEST(StartingValues, AreOfTheRightSize) {
  TuningRecording recording;
  recording.median_step_s = kStep_s;
  recording.samples = noisy_sine(3000, 1e-4);
  const NoiseModel start = starting_values({&recording, 1});
  EXPECT_GT(start.position_sd_m, 0.7e-4);
  EXPECT_LT(start.position_sd_m, 1.4e-4);
  // Two-sided density of the jerk, 1.24 m/s^3 of amplitude at 1 Hz seen for about the third of a
  // second over which third differences are taken.
  EXPECT_GT(start.jerk_density_m2_s5, 0.01);
  EXPECT_LT(start.jerk_density_m2_s5, 100);
}

// What is said of a recording that nothing can be learned from.
std::string refusal_of(const std::string& csv, FaultPolicy faults = FaultPolicy::event) {
  const TemporaryFolder folder;
  TuningInput input;
  input.choice.reading.faults = faults;
  input.most_samples = 100'000;
  try {
    (void)read_for_tuning(
        folder.write("r.csv", csv), input, [](double) {}, [] { return false; });
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

std::string rows(int count, const char* position(int)) {
  std::string text = "time_s,position_m\n";
  for (int i = 0; i < count; ++i) text += std::to_string(0.01 * i) + "," + position(i) + "\n";
  return text;
}

TEST(TuningRecording, RefusesWhatNothingCanBeLearnedFrom) {
  EXPECT_THAT(refusal_of(rows(1000, [](int) { return "0.001"; })), HasSubstr("never changes"));
  EXPECT_THAT(refusal_of(rows(1000, [](int) { return ""; })), HasSubstr("always missing"));
  EXPECT_THAT(refusal_of(rows(1000, [](int) { return "nan"; }), FaultPolicy::refuse),
              HasSubstr("always missing"));
  EXPECT_THAT(refusal_of(rows(2, [](int i) { return i > 0 ? "0.001" : "0"; })),
              HasSubstr("has 2 usable positions"));
  EXPECT_THAT(refusal_of("time_s,position_m\n1,0\n1,0\n"), HasSubstr("no time passes"));
}

// Its clock was set, and the first position after that is not there.
TEST(TuningRecording, LeavesGapsOutOfTheTime) {
  std::string text = "time_s,position_m\n";
  const auto samples = noisy_sine(1000, 1e-4);
  double time_s = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    time_s += samples[i].step_s + (i == 500 ? 1.7e9 : 0);
    text += fmt::format("{:.9f},", time_s);
    text += i == 500 ? "\n" : fmt::format("{:.9f}\n", samples[i].position_m);
  }
  const TemporaryFolder folder;
  TuningInput input;
  input.choice.reading.faults = FaultPolicy::event;
  input.most_samples = 100'000;
  const TuningRecording recording = read_for_tuning(
      folder.write("r.csv", text), input, [](double) {}, [] { return false; });
  double duration_s = 0;
  for (const TuningSample& sample : recording.samples) duration_s += sample.step_s;
  EXPECT_LT(duration_s, 11);
  EXPECT_LT(SplitRecording(recording).stretch_count(), 25U);
  EXPECT_EQ(recording.usable, 999U);
}

TEST(TuningRecording, LeavesOutliersOut) {
  std::string text = "time_s,position_m\n";
  const auto samples = noisy_sine(1000, 1e-4);
  double time_s = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    time_s += samples[i].step_s;
    const double glitch_m = i % 200 == 150 ? 0.01 : 0;
    text += fmt::format("{:.9f},{:.9f}\n", time_s, samples[i].position_m + glitch_m);
  }
  const TemporaryFolder folder;
  TuningInput input;
  input.most_samples = 100'000;
  const TuningRecording recording = read_for_tuning(
      folder.write("r.csv", text), input, [](double) {}, [] { return false; });
  EXPECT_EQ(recording.seen, 1000U);
  EXPECT_EQ(recording.rejected, 5U);
  EXPECT_EQ(recording.usable, 995U);
  for (const TuningSample& sample : recording.samples) {
    EXPECT_FALSE(std::abs(sample.position_m) > 6e-3);
  }
}

}  // namespace
}  // namespace condyle::host
