// SPDX-License-Identifier: Apache-2.0
// A point that chews without end, known exactly, and its identification.
#pragma once

#include <cmath>
#include <memory>
#include <random>

#include "condyle/estimator/impedance/point_identification.h"

namespace condyle::testing_support {

// A formula of a motion, and the force that makes it.
struct ChewingPoint {
  double mass_kg = 0.25, friction_Ns_m = 0.05, stiffness_N_m = 20, offset_N = 0.1, coulomb_N = 0;

  static double angle(double t) { return 8.2 * t + 0.8 * std::sin(1.1 * t); }
  static double position_m(double t) {
    return 0.007 * std::sin(angle(t)) + 0.002 * std::sin(2 * angle(t) + 1);
  }
  double force_N(double t) const {
    constexpr double kStep_s = 1e-4;
    const double before = position_m(t - kStep_s), here = position_m(t),
                 after = position_m(t + kStep_s), v = (after - before) / (2 * kStep_s);
    return mass_kg * (after - 2 * here + before) / (kStep_s * kStep_s) + friction_Ns_m * v +
           stiffness_N_m * here - offset_N + coulomb_N * v / std::sqrt(v * v + 25e-6);
  }
};

inline ImpedanceParameters exact() {
  ImpedanceParameters parameters;
  parameters.drive.gain_sd = parameters.drive.missing_share = 0;
  parameters.drive.delay_sd_s = 1e-5;
  return parameters;
}

// A drive of 137 Hz and positions of 60 Hz over `duration_s`, with little noise; `spoil(t, z)` may
// change a position or ask for it to be left out.
template <class Scalar, class Spoil>
std::unique_ptr<PointIdentification<Scalar>> identify(const ImpedanceParameters& parameters,
                                                      const ChewingPoint& chewing,
                                                      double duration_s, const Spoil& spoil) {
  auto identification = std::make_unique<PointIdentification<Scalar>>(parameters);
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  int drives = 0;
  for (int k = 0; k < duration_s * 60; ++k) {
    const double t = k / 60.0;
    for (; drives / 137.0 <= t; ++drives) {
      const double drive_N = chewing.force_N(drives / 137.0) + 1e-3 * noise(random);
      identification->add_drive(nanoseconds(drives / 137.0), static_cast<Scalar>(drive_N));
    }
    double position_m = ChewingPoint::position_m(t) + 1e-5 * noise(random);
    if (spoil(t, position_m)) {
      identification->add_position(nanoseconds(t), static_cast<Scalar>(position_m));
    }
  }
  identification->conclude();
  return identification;
}
inline constexpr auto kAsItIs = [](double, double&) { return true; };

}  // namespace condyle::testing_support
