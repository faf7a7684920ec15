// SPDX-License-Identifier: Apache-2.0
// Head motion against recordings of the other simulator: a mass of 1 whose drive is the head's
// acceleration. As identification_test.cpp; a row fails once in 10^6 times.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <memory>

#include "condyle/estimator/impedance/head_motion.h"
#include "identification/verdict.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::adversary {
namespace {

using testing_support::fewest_hits;
using testing_support::runs;

struct HeadAttack {
  Regime regime;
  HeadMotionParameters said{.delay_sd_s = 2e-4, .muscle_share = 0};
};

constexpr Point kJaw{.mass_kg = 1, .friction_Ns_m = 8, .stiffness_N_m = 400, .offset_N = 9.81};
constexpr Point jaw(double coulomb_N, double cube_N_m3, double drag_Ns2_m2) {
  Point point = kJaw;
  point.coulomb_N = coulomb_N;
  point.cube_N_m3 = cube_N_m3;
  point.drag_Ns2_m2 = drag_Ns2_m2;
  return point;
}
constexpr Motion kNods{.frequency_Hz = 2, .amplitude_m = 7e-3};
constexpr DriveSensor at(double rate_Hz, double gain = 1) {
  return {.rate_Hz = rate_Hz, .noise_N = 0.05, .gain = gain};
}

std::vector<HeadAttack> attacks() {
  std::vector<HeadAttack> all;
  const auto add = [&](Regime regime, double lever_sd = 0) {
    HeadAttack attack{regime};
    attack.regime.motion = kNods;
    if (attack.regime.point.mass_kg != 1) attack.regime.point = kJaw;
    attack.said.lever_sd = lever_sd;
    all.push_back(attack);
  };
  add({.name = "clean 60 Hz", .drive = at(60)});
  add({.name = "clean 200 Hz", .tracker = {.rate_Hz = 200}, .drive = at(200)});
  // No hold between accelerations is assumed.
  add({.name = "acceleration 50 Hz", .drive = at(50)});
  add({.name = "acceleration 60 Hz 60 s", .duration_s = 60, .drive = at(60)});
  add({.name = "acceleration 100 Hz", .drive = at(100)});
  add({.name = "acceleration 1 kHz", .drive = at(1000)});
  // The head turns.
  add({.name = "lever 2 % stated", .drive = at(60, 1.02)}, 0.02);
  add({.name = "lever 5 % stated", .drive = at(60, 0.95)}, 0.05);
  add({.name = "lever 3 % unsaid", .drive = at(60, 0.97)});
  add({.name = "lever 4 % unsaid", .drive = at(60, 1.04)});
  add({.name = "lever 5 % unsaid", .drive = at(60, 0.95)});
  add({.name = "lever 6 % unsaid", .drive = at(60, 1.06)});
  add({.name = "lever 10 % unsaid", .drive = at(60, 1.1)});
  // What the model does not have.
  add({.name = "hardening 5 %", .point = jaw(0, 4e5, 0), .drive = at(60)});
  add({.name = "Coulomb 0.02", .point = jaw(0.02, 0, 0), .drive = at(60)});
  add({.name = "drag 3", .point = jaw(0, 0, 3), .drive = at(60)});
  add({.name = "mean of 3", .tracker = {.mean_of = 3}, .drive = at(60)});
  for (const int mean_of : {3, 5, 9}) {
    add({.name = "quiet positions, smoothed",
         .tracker = {.noise_m = 1e-5, .mean_of = mean_of, .is_centred = true},
         .drive = {.noise_N = 0.05}});
  }
  add({.name = "AR 0.9", .tracker = {.correlation = 0.9}, .drive = at(60)});
  add({.name = "low-pass 10 Hz", .drive = {.noise_N = 0.05, .low_pass_Hz = 10}});
  add({.name = "one frequency",
       .motion = {.frequency_Hz = 2, .amplitude_m = 7e-3, .second = 0, .third = 0},
       .drive = at(60)});
  return all;
}

class Head : public testing::TestWithParam<HeadAttack> {};

TEST_P(Head, IsCoveredOrWithheld) {
  const int kRuns = runs(4, 10, 200);
  Tally damping, stiffness;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const auto at = static_cast<std::uint64_t>(seed);
    Regime regime = GetParam().regime;
    const HeadMotionParameters& said = GetParam().said;
    Random random(at ^ 0x5DEECE66DU);
    regime.drive.gain *= 1 + said.gain_sd * random.normal();
    regime.drive.delay_s += said.delay_sd_s * random.normal();
    const Recording recording = simulate(regime, at);
    const auto identification = std::make_unique<HeadMotionIdentification<double>>(said);
    std::size_t next = 0;
    const auto add_until = [&](double time_s) {
      for (; next < recording.drive.size() && recording.drive[next].time_s <= time_s; ++next) {
        const Reading& force = recording.drive[next];
        identification->add_acceleration(nanoseconds(force.time_s), -force.value);
      }
    };
    for (const Reading& position : recording.positions) {
      add_until(position.time_s);
      identification->add_position(nanoseconds(position.time_s), position.value);
    }
    add_until(HUGE_VAL);
    identification->conclude();
    const auto estimate = identification->estimate();
    damping.add(verdict_of(estimate.damping_rate_per_s, effective_friction_Ns_m(regime, at)));
    stiffness.add(verdict_of(estimate.stiffness_per_mass_per_s2, regime.point.stiffness_N_m));
  }
  std::cout << line_of(GetParam().regime.name, "kv/m", damping)
            << line_of(GetParam().regime.name, "ks/m", stiffness);
  for (const Tally& tally : {damping, stiffness}) {
    if (tally.shown < 0.03 * tally.runs) continue;
    EXPECT_GE(static_cast<std::uint64_t>(tally.covered),
              fewest_hits(static_cast<std::uint64_t>(tally.shown), 0.9, 1e-3));
  }
}
INSTANTIATE_TEST_SUITE_P(Attacks, Head, testing::ValuesIn(attacks()),
                         [](const testing::TestParamInfo<HeadAttack>& test) {
                           return name_of(test.index, test.param.regime.name);
                         });

}  // namespace
}  // namespace condyle::adversary
