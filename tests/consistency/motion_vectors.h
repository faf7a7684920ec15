// SPDX-License-Identifier: Apache-2.0
// Simulated chewing with its true velocity (vectors/README.md), and what the recommended estimator
// makes of it.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "condyle/estimator/motion/recommended_estimator.h"

namespace condyle::testing_support {

/// Positions and true velocities of one motion.
struct MotionVector {
  std::vector<TimeNs> time_ns;
  std::vector<double> position_m, velocity_m_s;
  std::vector<bool> is_measured;

  std::size_t size() const { return time_ns.size(); }
};

/// One of the files, and the figures of design/model.md section 5 for it.
struct MotionFile {
  const char* name;
  double noise_sd_m;
  /// Velocity error (m/s, rms, the first 12 s left out) of the white-jerk filter at its grid-best
  /// density, 0, 1, 3 and 10 samples late.
  double error_m_s[4];
};

/// For messages of tests.
inline void PrintTo(const MotionFile& file, std::ostream* out) {
  *out << file.name;
}

/// The lags of `error_m_s`.
inline constexpr int kMotionLags[] = {0, 1, 3, 10};

inline constexpr MotionFile kMotionFiles[] = {
    {"motion_60hz_20um", 20e-6, {1.91e-3, 0.69e-3, 0.52e-3, 0.46e-3}},
    {"motion_60hz_100um", 100e-6, {5.28e-3, 2.85e-3, 1.39e-3, 1.21e-3}},
    {"motion_60hz_300um", 300e-6, {10.5e-3, 6.85e-3, 2.95e-3, 2.23e-3}},
    {"motion_200hz_100um", 100e-6, {4.24e-3, 3.47e-3, 2.24e-3, 0.97e-3}},
    {"motion_irregular_60hz_50um", 50e-6, {5.52e-3, 1.85e-3, 1.54e-3, 1.47e-3}},
    {"motion_irregular_200hz_50um", 50e-6, {4.51e-3, 3.14e-3, 1.47e-3, 0.97e-3}},
};

/// From when on errors count: what came before is settling.
inline constexpr double kSettled_s = 12;

/// Reads the file `name`; the motion is `scale` times as large, the noise is the same.
MotionVector read_motion(const std::string& name, double scale = 1);

/// Estimates of all samples in their order, whatever the lag.
template <class Scalar>
std::vector<RecommendedEstimate<Scalar>> estimate_motion(
    const MotionEstimatorParameters& parameters, int lag, const MotionVector& motion);

/// Velocity error (m/s, rms) of `estimates` from `from_s` on, where `counts` is empty or says so.
template <class Scalar>
double velocity_error(const MotionVector& motion,
                      const std::vector<RecommendedEstimate<Scalar>>& estimates, double from_s,
                      const std::vector<bool>& counts = {});

/// A white-jerk filter of known noise, density and error.
struct WhiteJerkFit {
  double ratio = 0;      ///< jerk density over noise variance (1/s^5)
  double error_m_s = 0;  ///< of the velocity, rms
};

/// The white-jerk filter, no adaptation, at the density that suits `motion` best, found by trying:
/// what the recommended estimator is held against.
WhiteJerkFit best_white_jerk_fit(const MotionVector& motion, double from_s);

}  // namespace condyle::testing_support
