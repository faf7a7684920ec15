// SPDX-License-Identifier: Apache-2.0
// What EMG tells of a simulated subject with muscles, its force as wrong as it is found to be, or
// with something that nobody states: where a value is shown, its interval holds the truth.
#include "condyle/estimator/emg/emg_timeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "simulation/simulation.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle {
namespace {

constexpr double kNoise_m = 5e-5, kLag_s = 0.03, kLagSd_s = 0.01;

struct Setting {
  double friction_Ns_m = 2;
  double error = 0.34;  ///< of each muscle's excitation, relative; makes the NRMSE of the force
  double resolution_Ns_m = 60;
  const char* name = "";
  // What nobody states.
  int dead = -1;     ///< a muscle whose electrode is off
  int swapped = -1;  ///< a muscle whose EMG is exchanged with the first one's
  double axis = 1;   ///< -1: the followed axis is reversed
  double food_height_m = 0;
};

// What EMG and instrument gave of a subject that chews.
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
  subject.food_height_m = setting.food_height_m;
  subject.steps_per_millisecond = setting.food_height_m > 0 ? 10 : 2;
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

// Stiffness and constant force of all that acts but muscles and friction, by least squares.
struct Passive {
  double count = 0, p = 0, pp = 0, force = 0, force_p = 0;
  void add(const host::SubjectTruth& truth) {
    double F = 0;
    for (const host::Cause cause : {host::Cause::weight, host::Cause::support, host::Cause::contact,
                                    host::Cause::food, host::Cause::load, host::Cause::offset}) {
      F += truth.force_N[static_cast<std::size_t>(cause)];
    }
    const double z = truth.position_m;
    ++count, p += z, pp += z * z, force += F, force_p += F * z;
  }
  double stiffness_N_m() const { return -(force_p - force * p / count) / (pp - p * p / count); }
  double offset_N() const { return (force + stiffness_N_m() * p) / count; }
};

struct Outcome {
  EmgEstimate<double> estimate;
  double stiffness_N_m = 0, offset_N = 0;   ///< true ones
  std::array<double, kMostMuscles> gain{};  ///< likewise
  double nrmse = 0, correlation = 0;        ///< of the muscles' force with the gains it has
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
  Passive passive;
  std::size_t next = 0;
  for (const host::Reading& reading : recorded.data.emg) {
    shared = kept * shared + fresh * normal(random);
    EmgTimeline<double>::Excitations excitation{};
    for (std::size_t n = 0; n < muscles.count; ++n) {
      own[n] = kept * own[n] + fresh * normal(random);
      const double wrong = setting.error * (0.8 * shared + 0.6 * own[n]);
      excitation[n] = std::max(0.0, gain[n] * reading.values[n] * (1 + wrong));
    }
    if (setting.dead >= 0) excitation[static_cast<std::size_t>(setting.dead)] = 1e-3;
    if (setting.swapped > 0) {
      std::swap(excitation[0], excitation[static_cast<std::size_t>(setting.swapped)]);
    }
    for (; next < recorded.data.samples.size() &&
           recorded.data.samples[next].time_ns <= reading.time_ns;
         ++next) {
      const Sample& sample = recorded.data.samples[next];
      timeline.add_position(sample.time_ns, setting.axis * sample.coordinates[0], kNoise_m);
      passive.add(recorded.data.truths[next]);
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
  Outcome outcome;
  outcome.estimate = timeline.estimate();
  outcome.stiffness_N_m = passive.stiffness_N_m();
  outcome.offset_N = setting.axis * passive.offset_N();
  for (std::size_t n = 0; n < muscles.count; ++n) outcome.gain[n] = setting.axis / gain[n];
  outcome.nrmse = std::sqrt(errors / truths);
  outcome.correlation = covariance / std::sqrt(variance * true_variance);
  return outcome;
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
    const auto& friction = outcome.estimate.friction_Ns_m;
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

class EmgValues : public testing::TestWithParam<Setting> {};

struct Score {
  std::uint64_t runs = 0, shown = 0, held = 0;
  void add(const EmgValue<double>& value, double truth) {
    ++runs;
    if (value.quantity.provenance != Provenance::derived) return;
    ++shown;
    const double error = std::abs(value.quantity.value - truth);
    held += error <= kNormalQuantile95 * value.quantity.standard_deviation ? 1 : 0;
  }
};

// Gains, stiffness and offset at the default resolutions. A value fails where fewer of the shown
// ones hold the truth than intervals of 90 % would leave once in 1000 times, unless less than 3 %
// of the runs show it. Where an electrode is off or exchanged the muscle's gain has no truth.
TEST_P(EmgValues, HoldOrAreWithheld) {
  const Setting& setting = GetParam();
  const int runs = testing_support::runs(4, 8, 100);
  Score gain, stiffness, offset;
  for (int seed = 1; seed <= runs; ++seed) {
    const Outcome outcome = identify(setting, static_cast<std::uint64_t>(seed));
    stiffness.add(outcome.estimate.stiffness_N_m, outcome.stiffness_N_m);
    offset.add(outcome.estimate.offset_N, outcome.offset_N);
    for (int n = 0; n < static_cast<int>(kMostMuscles); ++n) {
      if (n == setting.dead || n == setting.swapped || (n == 0 && setting.swapped > 0)) continue;
      const auto i = static_cast<std::size_t>(n);
      gain.add(outcome.estimate.gain[i], outcome.gain[i]);
    }
  }
  const auto expect_held = [&](const char* name, const Score& score) {
    std::cout << "             " << setting.name << ", " << name << ": shown " << score.shown
              << " of " << score.runs << ", of these held " << score.held << '\n';
    if (100 * score.shown < 3 * score.runs) return;
    EXPECT_GE(score.held, testing_support::fewest_hits(score.shown, 0.9, 1e-3)) << name;
  };
  expect_held("gains", gain);
  expect_held("stiffness", stiffness);
  expect_held("offset", offset);
}
INSTANTIATE_TEST_SUITE_P(
    Regimes, EmgValues,
    testing::Values(Setting{.name = "as stated"},
                    Setting{.friction_Ns_m = 10, .name = "friction of 10 Ns/m"},
                    Setting{.error = 2, .name = "errors of 2"},
                    Setting{.name = "superficial masseter off", .dead = 0},
                    Setting{.friction_Ns_m = 10, .name = "off, 10 Ns/m", .dead = 0},
                    Setting{.name = "anterior temporalis off", .dead = 2},
                    Setting{.friction_Ns_m = 0.1, .name = "exchanged", .swapped = 7},
                    Setting{.name = "axis reversed", .axis = -1},
                    Setting{.name = "food", .food_height_m = 0.006}));

}  // namespace
}  // namespace condyle
