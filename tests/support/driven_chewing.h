// SPDX-License-Identifier: Apache-2.0
// A jaw point that chews, driven by a force that is measured like its position.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "condyle/estimator/impedance/mass_spring_damper.h"

namespace condyle::testing_support {

struct DrivenTruth {
  double friction_Ns_m = 0.022, mass_kg = 0.25, stiffness_N_m = 20, offset_N = 0.2;
  double coulomb_N = 0;  ///< smooth over kSmooth_m_s; for steps far below a millisecond
  static constexpr double kSmooth_m_s = 0.005;

  DrivenRates<double> rates() const {
    return {friction_Ns_m / mass_kg, 1 / mass_kg, stiffness_N_m / mass_kg, offset_N / mass_kg};
  }
};

struct DrivenSample {
  double position_m = 0, drive_N = 0;  // measured
  double true_position_m = 0, true_drive_N = 0;
};

/// Chewing at 1.3 Hz, 15 mm, two harmonics whose strength and rate wander. The drive keeps
/// the point near that motion. It is linear between samples, as the filter assumes. Then both are
/// measured with noise.
class DrivenChewing {
 public:
  static constexpr double kPositionSd_m = 5e-5, kDriveSd_N = 0.01;

  DrivenChewing(const DrivenTruth& truth, double rate_Hz, unsigned seed)
      : T_s_(1 / rate_Hz), random_(seed) {
    become(truth);
  }

  /// Changes the properties of the point from now on.
  void become(const DrivenTruth& truth) {
    truth_ = truth;
    rates_ = truth.rates();
    response_ = driven_response(rates_, T_s_);
  }

  /// Cycles begun so far.
  double cycles() const { return phase_ / (2 * std::numbers::pi); }
  double sample_time_s() const { return T_s_; }

  DrivenSample next() {
    const double T = T_s_, m = truth_.mass_kg;
    cycle_Hz_ += 0.5 * T * (1.3 - cycle_Hz_) + 0.1 * std::sqrt(T) * normal_(random_);
    strength_ += 0.5 * T * (1 - strength_) + 0.15 * std::sqrt(T) * normal_(random_);
    const double w = 2 * std::numbers::pi * cycle_Hz_;
    phase_ += w * T;
    const double wanted_m =
        0.0075 * strength_ * (std::sin(phase_) + 0.25 * std::sin(2 * phase_ + 1));
    const double pull = 40 * (wanted_m - p_) - 1.5 * v_;  // towards it
    const double accelerating =
        -0.0075 * strength_ * w * w * (std::sin(phase_) + std::sin(2 * phase_ + 1));
    const double drive_N = m * (accelerating + pull) + truth_.friction_Ns_m * v_ +
                           truth_.stiffness_N_m * p_ - truth_.offset_N;
    if (is_started_) {
      const double sliding_N = truth_.coulomb_N * std::tanh(v_ / DrivenTruth::kSmooth_m_s);
      const auto step = driven_step<double>(rates_, response_, p_, v_, before_N_ - sliding_N,
                                            drive_N - sliding_N);
      p_ = step.position[kSolution];
      v_ = step.velocity[kSolution];
    }
    is_started_ = true;
    before_N_ = drive_N;
    const double measured_m = p_ + kPositionSd_m * normal_(random_);
    return {measured_m, drive_N + kDriveSd_N * normal_(random_), p_, drive_N};
  }

 private:
  double T_s_, cycle_Hz_ = 1.3, strength_ = 1, phase_ = 0, p_ = 0, v_ = 0, before_N_ = 0;
  bool is_started_ = false;
  DrivenTruth truth_;
  DrivenRates<double> rates_;
  DrivenResponse<double> response_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace condyle::testing_support
