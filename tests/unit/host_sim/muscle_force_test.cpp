// SPDX-License-Identifier: Apache-2.0
// The muscle model: the forces are those that move the simulated jaw.
#include "condyle/estimator/emg/muscle_force.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/scenario_file.h"
#include "support/paths.h"

namespace condyle {
namespace {

void expect_simulated_forces(const char* name) {
  const host::Scenario scenario =
      host::load_scenario(testing_support::source_path("/host_sim/scenarios/") + name + ".toml");
  const host::Jaw& jaw = scenario.subject.jaw;
  host::SimulatedSubject subject(scenario.subject, 1);
  double largest_N = 0;
  for (int i = 0; i < 30000; ++i) {
    subject.step();
    if (i % 50 != 0) continue;
    const host::SubjectTruth truth = subject.truth();
    double force_N = 0;
    float force_in_float_N = 0;
    const double q = jaw.geometry().coordinate_at(truth.position_m);
    for (std::size_t n = 0; n < jaw.muscles.size(); ++n) {
      const MuscleParameters muscle = jaw.muscles[n].parameters();
      force_N += jaw.muscles[n].gain * followed_force_N(jaw.geometry(), muscle, truth.activation[n],
                                                        q, truth.coordinate_rate);
      force_in_float_N +=
          followed_force_N(jaw.geometry(), muscle, static_cast<float>(truth.activation[n]),
                           static_cast<float>(q), static_cast<float>(truth.coordinate_rate));
    }
    const double expected_N = truth.force_N[static_cast<std::size_t>(host::Cause::muscle)];
    ASSERT_NEAR(q, truth.coordinate, 1e-12);
    ASSERT_NEAR(force_N, expected_N, 1e-9);
    ASSERT_NEAR(static_cast<double>(force_in_float_N), expected_N, 1e-3);
    largest_N = std::max(largest_N, std::abs(expected_N));
  }
  EXPECT_GT(largest_N, 0.05) << "it moves";
}

TEST(MuscleForce, IsThatOfTheSimulatedHinge) {
  expect_simulated_forces("free_opening");
}
TEST(MuscleForce, IsThatOfTheSimulatedTranslation) {
  expect_simulated_forces("side_to_side");
}

}  // namespace
}  // namespace condyle
