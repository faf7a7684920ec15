// SPDX-License-Identifier: Apache-2.0
// The simulated subject: it obeys mechanics, its integration has converged, and chewing looks like
// chewing.
#include "simulation/subject.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "simulation/scenario_file.h"
#include "support/paths.h"

namespace condyle::host {
namespace {

Scenario scenario(const std::string& name) {
  return load_scenario(testing_support::source_path("/host_sim/scenarios/") + name + ".toml");
}

std::vector<SubjectTruth> run(const SubjectParameters& parameters, double duration_s,
                              std::uint64_t seed = 1) {
  SimulatedSubject subject(parameters, seed);
  std::vector<SubjectTruth> truths{subject.truth()};
  const auto steps_per_truth = static_cast<std::uint64_t>(parameters.steps_per_millisecond) * 5;
  for (std::uint64_t i = 1; subject.time_s() < duration_s; ++i) {
    subject.step();
    if (i % steps_per_truth == 0) truths.push_back(subject.truth());
  }
  return truths;
}

class EveryScenario : public testing::TestWithParam<const char*> {};

// What the forces did is what the motion shows: work adds up to kinetic energy, impulses to
// momentum.
TEST_P(EveryScenario, EnergyAndMomentumBalance) {
  const Scenario s = scenario(GetParam());
  const auto truths = run(s.subject, std::min(s.duration_s, 5.0));
  double work_scale_J = 1e-9, impulse_scale = 1e-9;
  for (const SubjectTruth& truth : truths) {
    double work_J = 0, impulse = 0;
    for (std::size_t cause = 0; cause < kCauses; ++cause) {
      work_J += truth.work_J[cause];
      impulse += truth.impulse[cause];
      work_scale_J = std::max(work_scale_J, std::abs(truth.work_J[cause]));
      impulse_scale = std::max(impulse_scale, std::abs(truth.impulse[cause]));
    }
    const double kinetic_J = truth.kinetic_energy_J - truths[0].kinetic_energy_J;
    ASSERT_NEAR(work_J, kinetic_J, 1e-6 * work_scale_J) << truth.time_s;
    ASSERT_NEAR(impulse, truth.momentum - truths[0].momentum, 1e-6 * impulse_scale) << truth.time_s;
  }
}

TEST_P(EveryScenario, HalvingTheStepChangesNothing) {
  const Scenario s = scenario(GetParam());
  SubjectParameters fine = s.subject;
  fine.steps_per_millisecond *= 2;
  const auto coarse = run(s.subject, std::min(s.duration_s, 5.0));
  const auto halved = run(fine, std::min(s.duration_s, 5.0));
  ASSERT_EQ(coarse.size(), halved.size());
  double largest_m = 0, largest_difference_m = 0;
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    ASSERT_NEAR(coarse[i].time_s, halved[i].time_s, 1e-9);
    largest_m = std::max(largest_m, std::abs(coarse[i].position_m));
    largest_difference_m =
        std::max(largest_difference_m, std::abs(coarse[i].position_m - halved[i].position_m));
  }
  EXPECT_LE(largest_difference_m, 1e-6 * largest_m);
}

INSTANTIATE_TEST_SUITE_P(Shipped, EveryScenario,
                         testing::Values("chewing", "free_opening", "protrusion", "side_to_side",
                                         "rest", "clench", "passive_release", "chin_load",
                                         "point_mass", "prescribed"),
                         [](const auto& name) { return std::string(name.param); });

// The step that a scenario gets by itself suffices for every friction law.
TEST(FrictionLaws, HaveConvergedAtTheirStep) {
  for (const FrictionModel model : {FrictionModel::viscous, FrictionModel::coulomb,
                                    FrictionModel::stribeck, FrictionModel::lugre}) {
    SubjectParameters coarse = scenario("point_mass").subject;
    coarse.drive_friction_Ns_m = 0;
    coarse.friction.model = model;
    coarse.friction.coulomb_N = 0.05;
    coarse.friction.static_N = 0.08;
    coarse.steps_per_millisecond =
        static_cast<int>(std::max(10.0, needed_steps_per_millisecond(coarse)));
    SubjectParameters fine = coarse;
    fine.steps_per_millisecond *= 2;
    const auto a = run(coarse, 3), b = run(fine, 3);
    double largest_m = 0, largest_difference_m = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      largest_m = std::max(largest_m, std::abs(a[i].position_m));
      largest_difference_m =
          std::max(largest_difference_m, std::abs(a[i].position_m - b[i].position_m));
    }
    EXPECT_GT(largest_m, 1e-3) << "it moves";
    EXPECT_LE(largest_difference_m, 1e-6 * largest_m) << static_cast<int>(model);
  }
}

struct CycleFigures {
  std::vector<double> duration_s, depth_m, peak_speed_m_s, peak_acceleration_m_s2;
};

// Cycles from one deepest opening to the next.
CycleFigures cycles_of(const std::vector<SubjectTruth>& truths) {
  CycleFigures figures;
  std::size_t deepest = 0, previous = 0;
  for (std::size_t i = 1; i < truths.size(); ++i) {
    if (truths[i].position_m < truths[deepest].position_m) deepest = i;
    const bool closed = truths[i].position_m > -0.005;
    if (!closed || truths[deepest].position_m > -0.008) {
      if (closed) deepest = i;
      continue;
    }
    if (previous > 0) {
      double speed_m_s = 0, acceleration_m_s2 = 0;
      for (std::size_t k = previous; k < deepest; ++k) {
        speed_m_s = std::max(speed_m_s, std::abs(truths[k].velocity_m_s));
        acceleration_m_s2 = std::max(acceleration_m_s2, std::abs(truths[k].acceleration_m_s2));
      }
      figures.duration_s.push_back(truths[deepest].time_s - truths[previous].time_s);
      figures.depth_m.push_back(-truths[deepest].position_m);
      figures.peak_speed_m_s.push_back(speed_m_s);
      figures.peak_acceleration_m_s2.push_back(acceleration_m_s2);
    }
    previous = deepest;
    deepest = i;
  }
  return figures;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

double spread(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high / *low;
}

// Ranges found in chewing: 0.65-1.6 Hz, 15-37 mm, peak 58-143 mm/s, 1-2 m/s^2.
TEST(Chewing, LooksLikeChewing) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Scenario s = scenario("chewing");
    const CycleFigures cycles = cycles_of(run(s.subject, s.duration_s, seed));
    ASSERT_GT(cycles.depth_m.size(), 20U);
    const double rate_Hz = 1 / median(cycles.duration_s);
    EXPECT_GE(rate_Hz, 0.65);
    EXPECT_LE(rate_Hz, 1.6);
    EXPECT_GE(median(cycles.depth_m), 0.015);
    EXPECT_LE(median(cycles.depth_m), 0.037);
    EXPECT_GE(median(cycles.peak_speed_m_s), 0.058);
    EXPECT_LE(median(cycles.peak_speed_m_s), 0.143);
    EXPECT_GE(median(cycles.peak_acceleration_m_s2), 1);
    EXPECT_LE(median(cycles.peak_acceleration_m_s2), 2);
    EXPECT_GT(spread(cycles.depth_m), 1.2) << "irregular";
    EXPECT_GT(spread(cycles.duration_s), 1.3) << "irregular, with pauses";
  }
}

// z'' + 2 zeta w z' + w^2 z = 0 has a known solution.
TEST(PassiveRelease, IsADampedOscillation) {
  const Scenario s = scenario("passive_release");
  const double lambda = s.subject.friction.viscous_Ns_m / s.subject.jaw.mass_kg / 2;
  const double w =
      std::sqrt(s.subject.support_stiffness_N_m / s.subject.jaw.mass_kg - lambda * lambda);
  for (const SubjectTruth& truth : run(s.subject, 0.3)) {
    const double t = std::max(0.0, truth.time_s - s.subject.release_s);
    if (truth.position_m > 0) break;  // the teeth meet
    const double expected_m =
        s.subject.support_rest_m - s.subject.task.amplitude_m * std::exp(-lambda * t) *
                                       (std::cos(w * t) + lambda / w * std::sin(w * t));
    ASSERT_NEAR(truth.position_m, expected_m, 1e-10) << truth.time_s;
  }
}

TEST(Prescribed, FrictionChangesTheForceAndNotTheMotion) {
  SubjectParameters smooth = scenario("prescribed").subject, rough = smooth;
  rough.friction.viscous_Ns_m *= 22;
  const auto a = run(smooth, 5), b = run(rough, 5);
  double difference_N = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].position_m, b[i].position_m);
    difference_N = std::max(difference_N, std::abs(a[i].drive_N() - b[i].drive_N()));
    ASSERT_NEAR(a[i].drive_N() - b[i].drive_N(),
                (smooth.friction.viscous_Ns_m - rough.friction.viscous_Ns_m) * a[i].velocity_m_s,
                1e-12);
  }
  EXPECT_GT(difference_N, 0.02);
}

TEST(PointMass, FrictionChangesTheMotionUnderTheSameForce) {
  SubjectParameters smooth = scenario("point_mass").subject, rough = smooth;
  rough.friction.viscous_Ns_m *= 22;
  const auto a = run(smooth, 5), b = run(rough, 5);
  double difference_m = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i].drive_N(), b[i].drive_N(), 1e-12);
    difference_m = std::max(difference_m, std::abs(a[i].position_m - b[i].position_m));
  }
  EXPECT_GT(difference_m, 1e-3);
}

TEST(Jaw, EffectiveMassesAreTheTabulatedOnes) {
  EXPECT_NEAR(9.7e-4 / (0.089 * 0.089), 0.122, 0.001);
  // Along the path of the incisor point, I/R^2; along the vertical, more by 1/cos^2.
  for (const auto& [name, mass_kg] : {std::pair{"artisynth", 0.122}, std::pair{"anybody", 0.437}}) {
    const Jaw jaw = tabulated_hinge_jaw(name);
    const double cosine = std::cos(jaw.incisor_angle_rad);
    EXPECT_NEAR(jaw.effective_mass_kg(0) * cosine * cosine, mass_kg, 0.001);
  }
}

TEST(Jaw, GeometryIsConsistent) {
  const Jaw jaw = tabulated_hinge_jaw("anybody");
  for (const double q : {0.0, 0.1, 0.3}) {
    const double h = 1e-6;
    EXPECT_NEAR(jaw.followed_slope(q),
                (jaw.followed_position_m(q + h) - jaw.followed_position_m(q - h)) / (2 * h), 1e-9);
    EXPECT_NEAR(jaw.followed_curvature(q),
                (jaw.followed_slope(q + h) - jaw.followed_slope(q - h)) / (2 * h), 1e-9);
    EXPECT_NEAR(jaw.coordinate_at(jaw.followed_position_m(q)), q, 1e-12);
  }
}

TEST(Muscle, FactorsHaveTheirKnownPoints) {
  const Muscle muscle{.arm = -0.037};
  EXPECT_EQ(force_length_factor(muscle, 0.0), 1);
  EXPECT_LT(force_length_factor(muscle, 0.4), 0.6);
  EXPECT_EQ(force_velocity_factor(muscle, 0.0), 1);
  const double fastest = 0.04 * 10 / 0.037;  // opening rate that stretches 10 lengths per second
  EXPECT_EQ(force_velocity_factor(muscle, -fastest), 0);
  EXPECT_EQ(force_velocity_factor(muscle, -2 * fastest), 0);
  EXPECT_LT(force_velocity_factor(muscle, 100 * fastest), 1.4);
  EXPECT_NEAR(force_velocity_factor(muscle, 1e-6) - force_velocity_factor(muscle, -1e-6),
              2e-6 * 5 / fastest, 1e-9)
      << "one slope at rest";
  EXPECT_DOUBLE_EQ(activation_rate(0.0, 1.0), 100);
  EXPECT_DOUBLE_EQ(activation_rate(1.0, 0.0), -25);
}

}  // namespace
}  // namespace condyle::host
