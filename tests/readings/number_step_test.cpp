// SPDX-License-Identifier: Apache-2.0
// Recordings whose numbers have few digits: a still jaw stays on one number.
#include "readings/number_step.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "readings/simulated_readings.h"
#include "statistics/random.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::host {
namespace {

TEST(NumberStep, IsFoundWhateverItIs) {
  RandomGenerator random(1);
  for (const double step_m : {1e-6, 1e-5, 1e-3 / 128, 5e-5, 1e-4, 1e-3}) {
    std::vector<double> numbers;
    for (int i = 0; i < 500; ++i) {
      numbers.push_back(0.3 + step_m * std::round(5 * random.normal()));
    }
    EXPECT_NEAR(step_of(numbers), step_m, 1e-9 * step_m);
    numbers.push_back(std::nan(""));
    EXPECT_NEAR(step_of(numbers), step_m, 1e-9 * step_m);
  }
}

TEST(NumberStep, IsNoneOfManyDigitsAndOfFewNumbers) {
  RandomGenerator random(2);
  std::vector<double> numbers;
  for (int i = 0; i < 15; ++i) numbers.push_back(i * 1e-4);
  EXPECT_EQ(step_of(numbers), 0);
  numbers.clear();
  for (int i = 0; i < 500; ++i) numbers.push_back(1e-4 * random.normal());
  EXPECT_EQ(step_of(numbers), 0);
  EXPECT_EQ(step_of({}), 0);
}

struct Steps {
  double step_m, noise_m;
};

// Without the steps, 89 % of the intervals of the first recordings held and 84 % of the last ones.
// Half of the readings were withheld.
TEST(NumberStep, OfARecordingIsInTheIntervals) {
  const int runs = testing_support::runs(6, 12, 200);
  for (const Steps& steps : {Steps{1e-4, 1e-5}, Steps{1e-4, 5e-5}, Steps{1e-5, 1e-6}}) {
    JawScenario scenario;
    for (const JawTaskKind kind :
         {JawTaskKind::rest, JawTaskKind::opening, JawTaskKind::protrusion, JawTaskKind::left}) {
      scenario.tasks.push_back(default_task(kind));
    }
    scenario.facebow.rate_Hz = 100;
    scenario.facebow.noise_m = steps.noise_m;
    scenario.facebow.noise_rad = steps.noise_m / 0.05;
    scenario.landmarks = {1e-4, 1e-4, 1e-4};
    const auto jaw = std::make_shared<const KinematicJaw>(scenario);
    const auto truth = true_readings(*jaw);
    Coverages coverages;
    for (int run = 0; run < runs; ++run) {
      // Another place of the instrument rounds otherwise.
      const KinematicSimulation simulation(jaw, scenario, 900 + static_cast<std::uint64_t>(run));
      std::vector<Sample> samples = simulation.samples();
      RandomGenerator random(5, static_cast<std::uint64_t>(run));
      std::array<double, 9> offsets_m;
      for (double& offset_m : offsets_m) offset_m = steps.step_m * random.uniform();
      for (Sample& sample : samples) {
        for (std::size_t i = 0; i < offsets_m.size(); ++i) {
          double& number = sample.coordinates[i];
          number = steps.step_m * std::round((number + offsets_m[i]) / steps.step_m) - offsets_m[i];
        }
      }
      SampleRecording recording(samples);
      AnalysisChoice choice;
      choice.tasks = stated_tasks(simulation);
      const Analysis analysis =
          analyse(recording, "steps", stated_landmarks(simulation, scenario.landmarks), choice);
      compare_means(analysis, truth, coverages);
    }
    std::uint64_t shown = 0, covered = 0;
    for (const auto& [key, coverage] : coverages) {
      shown += static_cast<std::uint64_t>(coverage.shown);
      covered += static_cast<std::uint64_t>(coverage.covered);
    }
    std::printf("steps of %.3f mm, noise of %.3f mm: %.1f %% of %d intervals hold\n",
                1e3 * steps.step_m, 1e3 * steps.noise_m,
                100 * static_cast<double>(covered) / static_cast<double>(shown),
                static_cast<int>(shown));
    EXPECT_GT(shown, 40U * static_cast<std::uint64_t>(runs));
    // Intervals of a recording share its reference: as if each reading were one of six.
    EXPECT_GE(covered / 6, testing_support::fewest_hits(shown / 6, 0.9, 1e-4));
  }
}

}  // namespace
}  // namespace condyle::host
