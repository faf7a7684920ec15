// SPDX-License-Identifier: Apache-2.0
// Friction from EMG of a simulated subject with muscles, the EMG's force as wrong as it is found to
// be: where a value is shown, its interval holds the truth.
#include "condyle/estimator/emg/emg_timeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "simulation/simulation.h"
#include "support/tier.h"

namespace condyle {
namespace {

constexpr double kNoise_m = 5e-5, kLag_s = 0.03, kLagSd_s = 0.01;

struct Setting {
  double friction_Ns_m = 2;
  double error = 0.34;  ///< of each muscle's excitation, relative; makes the NRMSE of the force
  double resolution_Ns_m = 60;
};

// What EMG and instrument gave of a subject that chews without food.
struct Recorded {
  host::Scenario scenario;
  host::SimulatedData data;
};

Recorded record(const Setting& setting, std::uint64_t seed) {
  Recorded recorded;
  host::Scenario& scenario = recorded.scenario;
  scenario.name = "emg";
  host::SubjectParameters& subject = scenario.subject;
  subject.jaw = host::tabulated_hinge_jaw("artisynth");
  subject.friction.viscous_Ns_m = setting.friction_Ns_m;
  subject.contact_stiffness_N_m15 = 1e4;
  subject.steps_per_millisecond = 2;
  subject.task.rest_position_m = -0.002;
  subject.task.amplitude_m = 0.015;
  subject.task.amplitude_spread = 0.12;
  subject.task.cycle_rate_Hz = 1.15;
  subject.task.rate_spread = 0.08;
  subject.task.dwell_share = 0.1;
  scenario.facebow.gives_points = false;
  scenario.facebow.noise_m = kNoise_m;
  scenario.emg.rate_Hz = 500;
  scenario.emg.noise = 1e-4;
  host::Simulation simulation(scenario, seed);
  while (simulation.advance(recorded.data)) {
  }
  return recorded;
}

struct Outcome {
  EmgValue<double> friction;
  double nrmse = 0, correlation = 0;  ///< of the muscles' force with the gains it has
};

// The excitations get an error that stays alike for 0.2 s, shared by the muscles in part; gains
// differ by 30 %; the force is 30 +- 10 ms late.
Outcome identify(const Setting& setting, std::uint64_t seed) {
  const Recorded recorded = record(setting, seed);
  const host::Jaw& jaw = recorded.scenario.subject.jaw;
  MuscleSet muscles;
  muscles.jaw = jaw.geometry();
  for (const host::Muscle& muscle : jaw.muscles) {
    muscles.muscle[muscles.count++] = muscle.parameters();
  }
  EmgParameters parameters;
  parameters.mass_kg = {0.175, 0.035};
  parameters.friction_resolution_Ns_m = setting.resolution_Ns_m;
  EmgTimeline<double> timeline(parameters, muscles);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::array<double, kMostMuscles> own{}, gain{};
  double shared = normal(random);
  for (double& error : own) error = normal(random);
  for (double& factor : gain) factor = std::exp(0.3 * normal(random));
  const TimeNs lag_ns = nanoseconds(kLag_s + kLagSd_s * normal(random));
  const double kept = std::exp(-1 / (500 * 0.2)), fresh = std::sqrt(1 - kept * kept);
  double errors = 0, squares = 0, truths = 0, sum = 0, true_sum = 0, products = 0, count = 0;
  std::size_t next = 0;
  for (const host::Reading& reading : recorded.data.emg) {
    shared = kept * shared + fresh * normal(random);
    EmgTimeline<double>::Excitations excitation{};
    for (std::size_t n = 0; n < muscles.count; ++n) {
      own[n] = kept * own[n] + fresh * normal(random);
      const double wrong = setting.error * (0.8 * shared + 0.6 * own[n]);
      excitation[n] = std::max(0.0, gain[n] * reading.values[n] * (1 + wrong));
    }
    for (; next < recorded.data.samples.size() &&
           recorded.data.samples[next].time_ns <= reading.time_ns;
         ++next) {
      const Sample& sample = recorded.data.samples[next];
      timeline.add_position(sample.time_ns, sample.coordinates[0], kNoise_m);
      double force_N = 0;
      for (std::size_t n = 0; n < muscles.count; ++n) force_N += timeline.forces_N()[n] / gain[n];
      const double true_N =
          recorded.data.truths[next].force_N[static_cast<std::size_t>(host::Cause::muscle)];
      errors += std::pow(force_N - true_N, 2);
      squares += force_N * force_N;
      truths += true_N * true_N;
      products += force_N * true_N;
      sum += force_N;
      true_sum += true_N;
      ++count;
    }
    timeline.add_emg(reading.time_ns - lag_ns, excitation);
  }
  const double covariance = products - sum * true_sum / count;
  const double variance = squares - sum * sum / count;
  const double true_variance = truths - true_sum * true_sum / count;
  return {timeline.estimate().friction_Ns_m, std::sqrt(errors / truths),
          covariance / std::sqrt(variance * true_variance)};
}

class EmgRuns : public testing::TestWithParam<Setting> {};

// Intervals of 95 % hold in fewer than 90 % of 4, 8 or 200 shown values once in 5, 3 or 860 times,
// for each of five settings. These are wider and held in all of 200, so that a miss in the short
// forms, too, is rarer than once in 8 times; the seeds are fixed.
TEST_P(EmgRuns, IntervalsHoldOrTheValueIsWithheld) {
  const Setting setting = GetParam();
  const int runs = testing_support::runs(4, 8, 200);
  int shown = 0, held = 0, fitted_held = 0;
  double nrmse = 0, correlation = 0, sd_Ns_m = 0, squares = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    const Outcome outcome = identify(setting, static_cast<std::uint64_t>(seed));
    const auto& friction = outcome.friction;
    const double error = std::abs(friction.fitted - setting.friction_Ns_m);
    const bool holds = error < kNormalQuantile95 * friction.fitted_sd;
    fitted_held += holds ? 1 : 0;
    if (friction.limit == EmgLimit::none) {
      ++shown;
      held += holds ? 1 : 0;
      EXPECT_EQ(friction.quantity.provenance, Provenance::derived);
    } else {
      EXPECT_EQ(friction.quantity.provenance, Provenance::assumed);
    }
    nrmse += outcome.nrmse / runs;
    correlation += outcome.correlation / runs;
    sd_Ns_m += friction.fitted_sd / runs;
    squares += error * error / runs;
  }
  std::cout << "             kv " << setting.friction_Ns_m << " Ns/m, NRMSE " << nrmse
            << ", correlation " << correlation << ": error rms " << std::sqrt(squares)
            << ", stated sd " << sd_Ns_m << " Ns/m; shown " << shown << ", of these held " << held
            << "; all held " << fitted_held << " of " << runs << '\n';
  EXPECT_GE(held + (runs - shown), runs - runs / 10);
  EXPECT_GE(10 * held, 9 * shown);
  EXPECT_LT(correlation, 0.6) << "no better than EMG is";
  if (setting.resolution_Ns_m < 1) {
    EXPECT_EQ(shown, 0) << "no EMG tells a healthy joint's friction";
  }
}
INSTANTIATE_TEST_SUITE_P(Levels, EmgRuns,
                         testing::Values(Setting{0.1, 0.34, 0.1}, Setting{2, 0.34, 60},
                                         Setting{2, 0.57, 60}, Setting{2, 2, 60},
                                         Setting{10, 0.57, 60}));

}  // namespace
}  // namespace condyle
