// SPDX-License-Identifier: Apache-2.0
// Recordings whose times are off: the readings say so, and their intervals hold.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "readings/simulated_readings.h"
#include "statistics/random.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::host {
namespace {

struct Times {
  const char* name;
  double rate_Hz;
  double stamp_sd_s;  ///< by which each time is off
  double jitter_s;    ///< of the sampling instants, which are not reported
};
void PrintTo(const Times& times, std::ostream* out) {
  *out << times.name;
}

JawScenario scenario_of(const Times& times) {
  JawScenario scenario;
  for (const JawTaskKind kind :
       {JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::protrusion, JawTaskKind::chewing}) {
    scenario.tasks.push_back(default_task(kind));
  }
  scenario.facebow.rate_Hz = times.rate_Hz;
  scenario.facebow.jitter_s = times.jitter_s;
  scenario.facebow.noise_m = kFineNoise_m;
  scenario.facebow.noise_rad = kFineNoise_rad;
  scenario.landmarks = {1, 1, 1};
  return scenario;
}

Analysis analysed(const KinematicSimulation& simulation, const JawScenario& scenario,
                  const Times& times, std::uint64_t seed) {
  RandomGenerator random(seed, 9);
  std::vector<Sample> samples = simulation.samples();
  std::int64_t last_ns = -1;
  for (Sample& sample : samples) {
    sample.time_ns += static_cast<std::int64_t>(1e9 * times.stamp_sd_s * random.normal());
    sample.time_ns = std::max(sample.time_ns, last_ns + 100'000);
    last_ns = sample.time_ns;
  }
  SampleRecording recording(samples);
  AnalysisChoice choice;
  choice.tasks = stated_tasks(simulation);
  return analyse(recording, "simulation", stated_landmarks(simulation, scenario.landmarks), choice);
}

class StampedTimes : public testing::TestWithParam<Times> {};

// What depends on time: a true 90 % fails with a probability of 1e-4 for each of the 17 readings in
// each of five cells, 0.9 % in all. The seeds are fixed.
TEST_P(StampedTimes, AreInTheIntervals) {
  const Times& times = GetParam();
  const int runs = testing_support::runs(3, 6, 400);
  const JawScenario scenario = scenario_of(times);
  const auto jaw = std::make_shared<const KinematicJaw>(scenario);
  const auto truth = true_readings(*jaw);
  Coverages coverages;
  for (int run = 0; run < runs; ++run) {
    const auto seed = 700 + static_cast<std::uint64_t>(run);
    const KinematicSimulation simulation(jaw, scenario, seed);
    const Analysis analysis = analysed(simulation, scenario, times, seed);
    compare_means(analysis, truth, coverages);
    const double off_s = std::hypot(times.stamp_sd_s, times.jitter_s);
    if (off_s > 0) {
      EXPECT_NEAR(analysis.noise.stamp_sd_s, off_s, 0.4 * off_s);
    } else {
      EXPECT_EQ(analysis.noise.stamp_sd_s, 0);
    }
  }
  int compared = 0;
  for (const auto& [key, coverage] : coverages) {
    const bool is_of_time = key.find("_speed_mm_s") != std::string::npos ||
                            key.find("_time_s") != std::string::npos ||
                            key.ends_with("cycle_duration_s") || key.ends_with("sparc");
    if (!is_of_time || coverage.shown == 0) continue;
    ++compared;
    EXPECT_GE(static_cast<std::uint64_t>(coverage.covered),
              testing_support::fewest_hits(static_cast<std::uint64_t>(coverage.shown), 0.90, 1e-4))
        << key;
  }
  EXPECT_GT(compared, 10);
}

INSTANTIATE_TEST_SUITE_P(Cells, StampedTimes,
                         testing::Values(Times{"right", 100, 0, 0},
                                         Times{"off_by_1_ms_at_60_Hz", 60, 1e-3, 0},
                                         Times{"off_by_2_ms_at_100_Hz", 100, 2e-3, 0},
                                         Times{"off_by_1_ms_at_200_Hz", 200, 1e-3, 0},
                                         Times{"sampled_off_by_1_ms", 100, 0, 1e-3}),
                         [](const testing::TestParamInfo<Times>& times) {
                           return std::string(times.param.name);
                         });

}  // namespace
}  // namespace condyle::host
