// SPDX-License-Identifier: Apache-2.0
// A simulator against the identification, apart from host_sim's: the motion is given as a formula
// whose derivatives are exact, and the force follows from it (inverse dynamics). Nothing is
// integrated but what has a memory of its own.
//
//   theta(t)   phase: 2 pi f t, with slow sines that vary the rhythm
//   A(t)       height, likewise
//   x(t)       A (sin theta + h2 sin(2 theta + 1) + h3 sin(3 theta + 2)), and what a regime adds
//   F(t)       m x'' + kv x' + ks x + c, and what a regime adds
#pragma once

#include <cstdint>
#include <vector>

namespace condyle::adversary {

/// How the point moves.
struct Motion {
  double frequency_Hz = 1.3, amplitude_m = 7.5e-3;
  double second = 0.3, third = 0.1;                  ///< harmonics
  double rhythm_spread = 0.08, height_spread = 0.1;  ///< relative
  double sweep_Hz_per_s = 0;                         ///< of the frequency
  double tremor_Hz = 0, tremor_m = 0;
};

/// What holds it. Only the first four are what the identification assumes.
struct Point {
  double mass_kg = 0.25, friction_Ns_m = 0.05, stiffness_N_m = 20, offset_N = 0.1;
  double coulomb_N = 0;                    ///< with the sign of the velocity
  double bristle_N = 0, bristle_m = 1e-3;  ///< Dahl's friction: it needs that way to turn round
  double square_N_m2 = 0, cube_N_m3 = 0;   ///< of the position about the middle
  double contact_N_m = 0, contact_at_m = 0;
  double drag_Ns2_m2 = 0;
  double friction_end_share = 1;  ///< friction at the end over that at the start, linear
  double missing_Ns_m = 0;        ///< friction whose force the drive does not hold
  double mass_slope_per_m = 0;    ///< relative
};

/// What measures the position.
struct Tracker {
  double rate_Hz = 60, noise_m = 5e-5, rounding_m = 0;
  double jitter_s = 0;       ///< of the instants, which are stamped as they are
  double stamp_error_s = 0;  ///< of the stamps
  double drop_share = 0, outlier_share = 0, outlier_m = 3e-3;
  double correlation = 0;    ///< of the noise of neighbours (first order)
  int mean_of = 1;           ///< mean of samples, stamped with the last
  bool is_centred = false;   ///< stamped with its middle
  bool heavy_tails = false;  ///< Student's, 3 degrees of freedom
  double scale = 1;
};

/// What measures the drive.
struct DriveSensor {
  double rate_Hz = 60, noise_N = 0.01;
  double gain = 1, delay_s = 0, clock_ppm = 0;
  double low_pass_Hz = 0;
  double slow_noise_N = 0, slow_noise_Hz = 1;  ///< Ornstein-Uhlenbeck
  double drift_N = 0;                          ///< over the recording, linear
};

/// A recording and what made it.
struct Regime {
  const char* name = "";
  double duration_s = 30;
  Motion motion;
  Point point;
  Tracker tracker;
  DriveSensor drive;
};

struct Reading {
  double time_s = 0, value = 0;
};

/// Positions (m) and drive (N), each in order of their stamps.
struct Recording {
  std::vector<Reading> positions, drive;
};

/// Random numbers with the same values everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed);
  double uniform();  ///< in (0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double log_uniform(double low, double high);
  double normal();

 private:
  std::uint64_t state_;
};

Recording simulate(const Regime& regime, std::uint64_t seed);

/// Where the point truly is.
struct TruePoint {
  double time_s = 0, position_m = 0, velocity_m_s = 0, acceleration_m_s2 = 0;
};
std::vector<TruePoint> motion_of(const Regime& regime, std::uint64_t seed, double step_s);

/// The viscous friction that takes as much energy from that motion as all of its friction does;
/// where it changes, with what it is at the end (Ns/m).
double effective_friction_Ns_m(const Regime& regime, std::uint64_t seed);

}  // namespace condyle::adversary
