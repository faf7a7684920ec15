// SPDX-License-Identifier: Apache-2.0
#include "simulation/instrument.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"
#include "simulation/scenario_file.h"
#include "simulation/simulation.h"
#include "support/paths.h"

namespace condyle::host {
namespace {

SimulatedData simulate(const Scenario& scenario, std::uint64_t seed = 1) {
  Simulation simulation(scenario, seed);
  SimulatedData data;
  while (simulation.advance(data)) {
  }
  return data;
}

Scenario chewing(double duration_s = 10) {
  Scenario s = load_scenario(testing_support::source_path("/host_sim/scenarios/chewing.toml"));
  s.duration_s = duration_s;
  return s;
}

double distance_m(const Sample& sample, std::size_t a, std::size_t b) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double d = sample.coordinates[3 * a + i] - sample.coordinates[3 * b + i];
    sum += d * d;
  }
  return std::sqrt(sum);
}

// Three virtual points of one body: whatever the noise and the glitches, their distances stand.
TEST(Facebow, PointsBelongToOneRigidBody) {
  Scenario s = chewing();
  s.facebow.glitch_share = 0.05;
  for (const Sample& sample : simulate(s).samples) {
    ASSERT_NEAR(distance_m(sample, 0, 1), 0.03905, 1e-5);
    ASSERT_NEAR(distance_m(sample, 0, 2), 0.03905, 1e-5);
    ASSERT_NEAR(distance_m(sample, 1, 2), 0.050, 1e-9);
  }
}

TEST(Facebow, NoiseHasItsStandardDeviation) {
  Scenario s = chewing(60);
  s.facebow.rate_Hz = 200;
  const SimulatedData data = simulate(s);
  ASSERT_EQ(data.samples.size(), 12000U);
  double sum = 0;
  for (std::size_t i = 0; i < data.samples.size(); ++i) {
    const double error = data.samples[i].coordinates[2] - data.truths[i].position_m;
    sum += error * error;
  }
  // The sample deviation of 12,000 normal numbers strays by 0.65 %; 4 of that: false alarm 6e-5.
  EXPECT_NEAR(std::sqrt(sum / 12000) / s.facebow.noise_m, 1, 0.026);
}

TEST(Facebow, FaultsComeAsOftenAsAsked) {
  Scenario s = chewing(100);
  s.facebow.lost_share = 0.05;
  s.facebow.repeated_share = 0.03;
  s.facebow.jitter_s = 1e-3;
  const SimulatedData data = simulate(s);
  std::uint64_t lost = 0, repeated = 0;
  for (std::size_t i = 1; i < data.samples.size(); ++i) {
    const std::uint64_t step = data.samples[i].sequence - data.samples[i - 1].sequence;
    if (step == 0) ++repeated;
    if (step > 1) lost += step - 1;
    ASSERT_GE(data.samples[i].time_ns, data.samples[i - 1].time_ns);
  }
  // 6,000 draws: standard deviations 17 and 13; 4 of them: false alarm 1e-4.
  EXPECT_NEAR(static_cast<double>(lost), 300, 68);
  EXPECT_NEAR(static_cast<double>(repeated), 171, 53);
}

// The device believes in its regular clock: jitter shows in the position, not in the time.
TEST(Facebow, JitterIsNotReported) {
  Scenario s = chewing();
  s.facebow.jitter_s = 2e-3;
  const SimulatedData data = simulate(s);
  double largest_s = 0;
  for (std::size_t i = 0; i < data.samples.size(); ++i) {
    ASSERT_NEAR(seconds(data.samples[i].time_ns), static_cast<double>(i) / 60, 1e-9);
    largest_s = std::max(largest_s, std::abs(data.truths[i].time_s - static_cast<double>(i) / 60));
  }
  EXPECT_GT(largest_s, 2e-3);
}

TEST(Facebow, DropoutsGlitchesAndFreezesShow) {
  Scenario s = chewing(6);
  s.facebow.dropout = {2, 0.5};
  s.facebow.frozen = {4, 1};
  const SimulatedData faulty = simulate(s);
  s.facebow.dropout = s.facebow.frozen = {};
  s.facebow.glitch_share = 0.02;
  const SimulatedData glitched = simulate(s);
  s.facebow.glitch_share = 0;
  const SimulatedData clean = simulate(s);
  int zeros = 0, held = 0, glitches = 0;
  for (std::size_t i = 1; i < clean.samples.size(); ++i) {
    const double t = seconds(clean.samples[i].time_ns);
    zeros += faulty.samples[i].coordinates[2] == 0 && faulty.samples[i].coordinates[7] == 0;
    held += faulty.samples[i].coordinates[2] == faulty.samples[i - 1].coordinates[2] && t > 3;
    const double off_m =
        std::hypot(glitched.samples[i].coordinates[0] - clean.samples[i].coordinates[0],
                   glitched.samples[i].coordinates[1] - clean.samples[i].coordinates[1],
                   glitched.samples[i].coordinates[2] - clean.samples[i].coordinates[2]);
    if (off_m > 1e-9) {
      ++glitches;
      EXPECT_GE(off_m, 0.003 - 1e-9);
      EXPECT_LE(off_m, 0.008 + 1e-9);
    }
  }
  EXPECT_EQ(zeros, 30);
  EXPECT_EQ(held, 60);
  EXPECT_GT(glitches, 0);
}

TEST(Facebow, ClockSmoothingAndQuantumDoWhatTheySay) {
  Scenario s = chewing(5);
  s.facebow.clock_drift = 1e-3;
  s.facebow.latency_s = 0.02;
  s.facebow.quantum_m = 1e-5;
  const SimulatedData data = simulate(s);
  for (std::size_t i = 0; i < data.samples.size(); ++i) {
    ASSERT_NEAR(seconds(data.samples[i].time_ns), data.truths[i].time_s * 1.001 + 0.02, 1e-9);
    const double counts = data.samples[i].coordinates[2] / 1e-5;
    ASSERT_NEAR(counts, std::round(counts), 1e-6);
  }
  // Smoothing makes neighbouring errors alike.
  Scenario rest = load_scenario(testing_support::source_path("/host_sim/scenarios/rest.toml"));
  rest.subject.task.tremor_m = 0;
  const auto lag_1 = [&](double smoothing) {
    rest.facebow.smoothing = smoothing;
    const SimulatedData still = simulate(rest);
    double product = 0, square = 0;
    for (std::size_t i = 300; i < still.samples.size(); ++i) {
      const double a = still.samples[i - 1].coordinates[2] - still.truths[i - 1].position_m;
      const double b = still.samples[i].coordinates[2] - still.truths[i].position_m;
      product += a * b;
      square += b * b;
    }
    return product / square;
  };
  EXPECT_NEAR(lag_1(0), 0, 0.1);
  EXPECT_NEAR(lag_1(0.9), 0.9, 0.1);
}

TEST(Companions, ShowForceAndExcitationWithTheirFaults) {
  Scenario s = load_scenario(testing_support::source_path("/host_sim/scenarios/point_mass.toml"));
  s.duration_s = 5;
  s.drive = {.rate_Hz = 60,
             .noise_N = 0,
             .gain = 1.1,
             .missing_share = 0.2,
             .missing_in_phase_Ns_m = 0.5,
             .delay_s = 0.005};
  const SimulatedData data = simulate(s);
  ASSERT_GE(data.drive.size(), 299U);
  for (std::size_t i = 0; i < data.truths.size() && i < data.drive.size(); ++i) {
    ASSERT_NEAR(seconds(data.drive[i].time_ns), data.truths[i].time_s + 0.005, 1e-9);
    const SubjectTruth& truth = data.truths[i];
    ASSERT_NEAR(data.drive[i].values[0], 1.1 * (0.8 * truth.drive_N() - 0.5 * truth.velocity_m_s),
                1e-5);
  }
  Scenario muscles = chewing(5);
  muscles.emg = {.rate_Hz = 100, .noise = 0};
  Scenario half = muscles;
  half.emg.missing_share = 0.5;
  const SimulatedData emg = simulate(muscles);
  ASSERT_GE(emg.emg.size(), 499U);
  double largest = 0;
  for (const Reading& reading : emg.emg) {
    for (const double value : reading.values) {
      ASSERT_GE(value, 0);
      ASSERT_LE(value, 1);
      largest = std::max(largest, value);
    }
  }
  EXPECT_GT(largest, 0.001);
  const SimulatedData seen_half = simulate(half);
  for (std::size_t i = 0; i < emg.emg.size(); ++i) {
    ASSERT_DOUBLE_EQ(seen_half.emg[i].values[0], emg.emg[i].values[0] / 2);
  }
}

// What the jaw feels as inertia is minus the force that drives it, per mass, and gravity.
TEST(Companions, ShowTheAccelerationOfTheHead) {
  Scenario s = load_scenario(testing_support::source_path("/host_sim/scenarios/nodding_head.toml"));
  s.duration_s = 3;
  s.subject.jaw.mass_kg = 0.2;
  s.head = {.rate_Hz = s.facebow.rate_Hz, .noise_m_s2 = 0, .gain = 1.05, .delay_s = 0.004};
  const SimulatedData data = simulate(s);
  ASSERT_GE(data.head.size(), data.truths.size() - 1);
  double least = 1e9, most = -1e9;
  for (std::size_t i = 0; i + 1 < data.truths.size(); ++i) {
    ASSERT_NEAR(seconds(data.head[i].time_ns), data.truths[i].time_s + 0.004, 1e-9);
    const double felt_m_s2 = 9.81 - data.truths[i].drive_N() / 0.2;
    ASSERT_NEAR(data.head[i].values[0], 1.05 * felt_m_s2, 1e-5);
    least = std::min(least, felt_m_s2);
    most = std::max(most, felt_m_s2);
  }
  EXPECT_GT(most - least, 0.1);
}

TEST(Simulation, SaysWhenItBreaksDown) {
  Scenario s = chewing(2);
  s.subject.friction.viscous_Ns_m = 1e4;  // too stiff for the step, which a file would not allow
  EXPECT_THROW(simulate(s), InputError);
}

TEST(Simulation, SameSeedSameNumbersOtherSeedOthers) {
  const SimulatedData a = simulate(chewing(3), 7), b = simulate(chewing(3), 7),
                      c = simulate(chewing(3), 8);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  int differing = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    for (std::size_t k = 0; k < 9; ++k) {
      ASSERT_EQ(a.samples[i].coordinates[k], b.samples[i].coordinates[k]);
      differing += a.samples[i].coordinates[k] != c.samples[i].coordinates[k];
    }
  }
  EXPECT_GT(differing, 1000);
}

}  // namespace
}  // namespace condyle::host
