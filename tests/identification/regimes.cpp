// SPDX-License-Identifier: Apache-2.0
#include "identification/regimes.h"

namespace condyle::adversary {
namespace {

constexpr Statement kDefault, kFit{.fits_delay = true, .delay_sd_s = 5e-3},
    kKnown{.delay_sd_s = 5e-5, .gain_sd = 1e-3};
constexpr Motion kSine{.second = 0, .third = 0, .rhythm_spread = 0, .height_spread = 0};
constexpr Motion sine(double frequency_Hz, double amplitude_m = 7.5e-3) {
  Motion motion = kSine;
  motion.frequency_Hz = frequency_Hz;
  motion.amplitude_m = amplitude_m;
  return motion;
}
// Slow opening and closing.
constexpr Motion opening(double frequency_Hz, double amplitude_m = 7.5e-3) {
  return {.frequency_Hz = frequency_Hz,
          .amplitude_m = amplitude_m,
          .second = 0.1,
          .third = 0,
          .rhythm_spread = 0.05,
          .height_spread = 0.1};
}
constexpr Motion chewing(double frequency_Hz, double amplitude_m, double second, double third) {
  return {
      .frequency_Hz = frequency_Hz, .amplitude_m = amplitude_m, .second = second, .third = third};
}
constexpr Tracker at(double rate_Hz, double noise_m = 5e-5) {
  return {.rate_Hz = rate_Hz, .noise_m = noise_m};
}
constexpr DriveSensor drive(double rate_Hz, double noise_N = 0.01) {
  return {.rate_Hz = rate_Hz, .noise_N = noise_N};
}

std::vector<Attack> make_named() {
  std::vector<Attack> attacks;
  const auto add = [&](Regime regime, const Statement& said = kDefault,
                       const char* cannot_be_had = nullptr) {
    attacks.push_back({regime, said, cannot_be_had});
  };
  // Clean: everything stated is true.
  add({.name = "clean 60 Hz"});
  add({.name = "clean 200 Hz", .tracker = at(200), .drive = drive(200)});
  add({.name = "clean 60 Hz, known"}, kKnown);
  add({.name = "clean kv 0.5, known", .point = {.friction_Ns_m = 0.5}}, kKnown);
  add({.name = "clean m 0.1, 5 mm, 2 mN",
       .motion = {.amplitude_m = 2.5e-3},
       .point = {.mass_kg = 0.1},
       .drive = drive(60, 0.002)});
  add({.name = "clean 100 um", .tracker = at(60, 1e-4)});
  add({.name = "clean 10 s, known", .duration_s = 10}, kKnown);
  add({.name = "clean fit"}, kFit);
  add({.name = "clean fit 200 Hz", .tracker = at(200), .drive = drive(200)}, kFit);
  add({.name = "clean drive 1 kHz", .drive = drive(1000)});
  add({.name = "clean drive 30 Hz", .drive = drive(30)});
  add({.name = "clean rounded 0.1 mm, known", .tracker = {.noise_m = 2e-5, .rounding_m = 1e-4}},
      kKnown);
  add({.name = "clean sweep",
       .motion = {.frequency_Hz = 0.5, .second = 0, .third = 0, .sweep_Hz_per_s = 0.1}});
  add({.name = "clean 600 s, known", .duration_s = 600}, kKnown);
  add({.name = "clean m 0.05, known", .point = {.mass_kg = 0.05}}, kKnown);
  add({.name = "clean m 1, known", .point = {.mass_kg = 1}}, kKnown);
  add({.name = "clean kv 0, 5 um, 200 Hz, known",
       .point = {.friction_Ns_m = 0},
       .tracker = at(200, 5e-6),
       .drive = drive(200)},
      kKnown);
  add({.name = "clean 300 um", .tracker = at(60, 3e-4)});
  // 1: a drive quieter than stated.
  add({.name = "quiet opening 0.3 Hz 15 mm 60 s",
       .duration_s = 60,
       .motion = opening(0.3),
       .drive = drive(60, 0.002)});
  add({.name = "quiet opening 0.3 Hz 35 mm",
       .motion = opening(0.3, 17.5e-3),
       .drive = drive(60, 0.002)});
  add({.name = "quiet chewing 0.7 Hz",
       .motion = chewing(0.7, 7.5e-3, 0.15, 0),
       .drive = drive(60, 0.002)});
  add({.name = "quiet chewing 3 mm", .motion = {.amplitude_m = 1.5e-3}, .drive = drive(60, 0.002)});
  add({.name = "quiet sine 120 s", .duration_s = 120, .motion = kSine, .drive = drive(60, 0.001)});
  // 2: slow or nearly sinusoidal.
  add({.name = "sine 30 s", .motion = kSine});
  add({.name = "sine 120 s", .duration_s = 120, .motion = kSine});
  add({.name = "sine 300 s", .duration_s = 300, .motion = kSine});
  add({.name = "sine, 2nd 1 %, 120 s",
       .duration_s = 120,
       .motion = {.second = 0.01, .third = 0, .rhythm_spread = 0, .height_spread = 0}});
  add({.name = "sine, 2nd 2 %, 300 s",
       .duration_s = 300,
       .motion = {.second = 0.02, .third = 0, .rhythm_spread = 0, .height_spread = 0}});
  add({.name = "sine varied 2 %, 120 s",
       .duration_s = 120,
       .motion = {.second = 0, .third = 0, .rhythm_spread = 0.02, .height_spread = 0.02}});
  add({.name = "tapping 3 Hz 8 mm 60 s", .duration_s = 60, .motion = sine(3, 4e-3)});
  add({.name = "sine 2 Hz 60 s", .duration_s = 60, .motion = sine(2)});
  add({.name = "sine 2 Hz 120 s ks 0",
       .duration_s = 120,
       .motion = sine(2),
       .point = {.stiffness_N_m = 0}});
  add({.name = "opening 0.2 Hz 180 s", .duration_s = 180, .motion = opening(0.2)});
  add({.name = "opening 0.5 Hz 50 mN 60 s",
       .duration_s = 60,
       .motion = opening(0.5),
       .drive = drive(60, 0.05)});
  add({.name = "chewing 0.1 N 120 s", .duration_s = 120, .drive = drive(60, 0.1)});
  for (const double frequency_Hz : {0.5, 1.3, 2.0}) {
    add({.name = "fit sine", .motion = sine(frequency_Hz)}, kFit);
  }
  for (const double frequency_Hz : {0.2, 0.3, 0.4}) {
    add({.name = "fit opening", .motion = opening(frequency_Hz)}, kFit);
  }
  add({.name = "fit opening 0.3 Hz 200 Hz 120 s",
       .duration_s = 120,
       .motion = opening(0.3),
       .tracker = at(200),
       .drive = drive(200)},
      kFit);
  add({.name = "fit 0.65 Hz 2nd 0.1", .motion = chewing(0.65, 7.5e-3, 0.1, 0)}, kFit);
  add({.name = "fit 1 Hz 2nd 0.05", .motion = chewing(1, 7.5e-3, 0.05, 0)}, kFit);
  add({.name = "fit 50 mN 200 Hz", .tracker = at(200), .drive = drive(200, 0.05)}, kFit);
  add({.name = "fit 100 mN 200 Hz 120 s",
       .duration_s = 120,
       .tracker = at(200),
       .drive = drive(200, 0.1)},
      kFit);
  // 5: delay times damping.
  constexpr Statement k5{.delay_sd_s = 5e-3}, k2{.delay_sd_s = 2e-3}, kHalf{.gain_sd = 1e-3};
  add({.name = "delay 5 ms"}, k5);
  add({.name = "delay 5 ms ks 0", .point = {.stiffness_N_m = 0}}, k5);
  add({.name = "delay 5 ms kv 2",
       .motion = chewing(1.3, 7.5e-3, 0.3, 0),
       .point = {.friction_Ns_m = 2}},
      k5);
  add({.name = "delay 5 ms kv 2 300 um", .point = {.friction_Ns_m = 2}, .tracker = at(60, 3e-4)},
      k5);
  add({.name = "delay 2 ms kv 5", .point = {.friction_Ns_m = 5}}, k2);
  add({.name = "delay 0.5 ms kv 2", .point = {.friction_Ns_m = 2}}, kHalf);
  add({.name = "delay 0.5 ms kv 5 200 Hz",
       .point = {.friction_Ns_m = 5},
       .tracker = at(200),
       .drive = drive(200)},
      kHalf);
  // 6: what the model does not have.
  add({.name = "Coulomb 10 mN", .point = {.coulomb_N = 0.01}});
  add({.name = "Coulomb 10 mN 200 Hz",
       .point = {.coulomb_N = 0.01},
       .tracker = at(200),
       .drive = drive(200)});
  add({.name = "Coulomb 20 mN 300 um", .point = {.coulomb_N = 0.02}, .tracker = at(60, 3e-4)});
  add({.name = "Coulomb 2 mN known", .point = {.coulomb_N = 0.002}}, kKnown);
  add({.name = "Coulomb 5 mN known", .point = {.coulomb_N = 0.005}}, kKnown);
  add({.name = "hardening 3 %", .point = {.cube_N_m3 = 3000}});
  add({.name = "hardening 3 % known", .point = {.cube_N_m3 = 3000}}, kKnown);
  add({.name = "hardening k3 10000", .point = {.cube_N_m3 = 10000}});
  add({.name = "quadratic spring 100 known", .point = {.square_N_m2 = 100}}, kKnown);
  add({.name = "contact 5 N/m", .point = {.contact_N_m = 5, .contact_at_m = -5e-3}});
  add({.name = "contact 20 N/m", .point = {.contact_N_m = 20, .contact_at_m = -5e-3}});
  add({.name = "bristle 10 mN", .point = {.bristle_N = 0.01, .bristle_m = 3e-4}});
  add({.name = "bristle 5 mN 1 mm", .point = {.bristle_N = 0.005, .bristle_m = 1e-3}});
  add({.name = "drag 2", .point = {.drag_Ns2_m2 = 2}}, kKnown);
  // 7: nobody is asked for it, or it changes.
  add({.name = "positions 5 % large", .tracker = {.scale = 1.05}}, kDefault, "scale");
  add({.name = "friction changes x3", .point = {.friction_end_share = 3}});
  add({.name = "friction changes x3 600 s", .duration_s = 600, .point = {.friction_end_share = 3}});
  add({.name = "missing 0.05 Ns/m", .point = {.friction_Ns_m = 0.1, .missing_Ns_m = 0.05}},
      kDefault, "missing share");
  add({.name = "mass along the path 1 %/cm", .point = {.mass_slope_per_m = 1}}, kDefault,
      "a mass that varies along the path");
  add({.name = "clock 10 ppm 120 s known", .duration_s = 120, .drive = {.clock_ppm = 10}}, kKnown,
      "clock drift below what is stated");
  add({.name = "clock 50 ppm 300 s", .duration_s = 300, .drive = {.clock_ppm = 50}});
  // Units that nobody checked.
  add({.name = "drive in kN", .drive = {.noise_N = 1e-5, .gain = 1e-3}});
  add({.name = "drive in kgf", .drive = {.noise_N = 1e-3, .gain = 1 / 9.80665}});
  add({.name = "drive in mN", .drive = {.noise_N = 10, .gain = 1e3}});
  add({.name = "drive reversed", .drive = {.gain = -1}});
  add({.name = "drive reversed kv 0.5", .point = {.friction_Ns_m = 0.5}, .drive = {.gain = -1}});
  add({.name = "drive half as large", .drive = {.gain = 0.5}}, kDefault, "gain");
  // Noise that is not what it seems.
  add({.name = "slow drive noise 10 mN", .drive = {.slow_noise_N = 0.01}});
  add({.name = "slow drive noise 10 mN known", .drive = {.slow_noise_N = 0.01}}, kKnown);
  add({.name = "drive drifts 50 mN", .drive = {.drift_N = 0.05}});
  add({.name = "AR 0.5 known", .tracker = {.correlation = 0.5}}, kKnown);
  add({.name = "AR 0.9", .tracker = {.correlation = 0.9}});
  add({.name = "sine AR 0.9 120 s",
       .duration_s = 120,
       .motion = kSine,
       .tracker = {.correlation = 0.9}});
  add({.name = "mean of 3", .tracker = {.mean_of = 3}});
  add({.name = "mean of 5", .tracker = {.mean_of = 5}});
  // Smoothing that neither residual nor dynamics show: the positions' noise is far below the
  // drive's.
  for (const double rate_Hz : {60.0, 200.0}) {
    for (const int mean_of : {3, 5, 7, 15}) {
      add({.name = "quiet positions, smoothed",
           .motion = {.frequency_Hz = 2, .amplitude_m = 6e-3},
           .point = {.friction_Ns_m = 1, .stiffness_N_m = 60},
           .tracker = {.rate_Hz = rate_Hz, .noise_m = 1e-5, .mean_of = mean_of, .is_centred = true},
           .drive = {.rate_Hz = 100, .noise_N = 0.03}});
    }
  }
  add({.name = "Student noise", .tracker = {.heavy_tails = true}});
  add({.name = "outliers 1 %", .tracker = {.outlier_share = 0.01}});
  add({.name = "drops 10 % known", .tracker = {.drop_share = 0.1}}, kKnown);
  add({.name = "jitter 3 ms known", .tracker = {.jitter_s = 3e-3}}, kKnown);
  add({.name = "stamps 1 ms wrong known", .tracker = {.stamp_error_s = 1e-3}}, kKnown);
  add({.name = "drops 10 % drive 30 Hz", .tracker = {.drop_share = 0.1}, .drive = drive(30)});
  add({.name = "drive low-pass 10 Hz", .drive = {.low_pass_Hz = 10}});
  add({.name = "tremor 10 Hz 0.2 mm", .motion = {.tremor_Hz = 10, .tremor_m = 2e-4}});
  return attacks;
}

}  // namespace

ImpedanceParameters parameters_of(const Statement& said) {
  ImpedanceParameters parameters;
  parameters.drive.missing_share = 0;
  parameters.drive.gain_sd = said.gain_sd;
  parameters.drive.delay_sd_s = said.delay_sd_s;
  parameters.drive.delay_s = said.delay_s;
  parameters.delay = said.fits_delay ? DelayModel::fitted : DelayModel::known;
  return parameters;
}

Regime drawn(const Attack& attack, std::uint64_t seed) {
  Random random(seed ^ 0x5DEECE66DU);
  Regime regime = attack.regime;
  regime.drive.gain *= 1 + attack.said.gain_sd * random.normal();
  regime.drive.delay_s += attack.said.delay_s + attack.said.delay_sd_s * random.normal();
  return regime;
}

const std::vector<Attack>& named_attacks() {
  static const std::vector<Attack> attacks = make_named();
  return attacks;
}

Attack random_attack(const RandomClass& of, std::uint64_t seed) {
  Random random(seed ^ 0x2545F491U);
  Attack attack;
  Regime& regime = attack.regime;
  attack.said.fits_delay = of.fits_delay;
  attack.said.delay_sd_s = of.fits_delay ? 5e-3 : 5e-4;
  attack.said.gain_sd = random.uniform() < 0.5 ? 1e-3 : 1e-2;
  regime.duration_s = random.log_uniform(12, 150);
  regime.tracker.rate_Hz = random.log_uniform(60, 200);
  regime.drive.rate_Hz =
      random.uniform() < 0.5 ? regime.tracker.rate_Hz : random.log_uniform(60, 200);
  regime.tracker.noise_m = random.log_uniform(15e-6, 200e-6);
  regime.drive.noise_N = random.log_uniform(8e-4, 0.05);
  regime.motion.amplitude_m = random.log_uniform(2e-3, 12.5e-3);
  regime.point.mass_kg = random.log_uniform(0.06, 0.8);
  regime.point.friction_Ns_m = random.uniform(0, 1.5);
  regime.point.stiffness_N_m = random.uniform(0, 150);
  Motion& motion = regime.motion;
  switch (static_cast<int>(random.uniform(0, 5))) {
    case 0:
      motion.frequency_Hz = random.uniform(0.6, 2);
      break;
    case 1:
      motion = sine(random.uniform(0.4, 2.5), motion.amplitude_m);
      break;
    case 2:
      motion.frequency_Hz = random.uniform(0.6, 2);
      motion.second = random.log_uniform(0.02, 0.3);
      motion.third = 0;
      motion.rhythm_spread = random.uniform(0, 0.1);
      break;
    case 3:
      motion = opening(random.uniform(0.2, 0.6), motion.amplitude_m);
      break;
    default:
      motion.frequency_Hz = 0.4;
      motion.second = motion.third = 0;
      motion.sweep_Hz_per_s = 2.6 / regime.duration_s;
  }
  if (!of.has_unsaid_error) return attack;
  switch (static_cast<int>(random.uniform(0, 5))) {
    case 0:
      regime.point.coulomb_N = random.log_uniform(2e-3, 20e-3);
      break;
    case 1:
      regime.point.cube_N_m3 = random.log_uniform(500, 20000);
      break;
    case 2:
      regime.point.square_N_m2 = random.log_uniform(20, 500);
      break;
    case 3:
      regime.point.bristle_N = random.log_uniform(2e-3, 10e-3);
      regime.point.bristle_m = random.log_uniform(1e-4, 1e-3);
      break;
    default:
      regime.point.contact_N_m = random.log_uniform(2, 20);
      regime.point.contact_at_m = random.uniform(-1, 0.5) * motion.amplitude_m;
  }
  return attack;
}

}  // namespace condyle::adversary
