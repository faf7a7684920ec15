// SPDX-License-Identifier: Apache-2.0
// A relaxed jaw in a head that nods, and an accelerometer on it.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "condyle/estimator/impedance/mass_spring_damper.h"

namespace condyle::testing_support {

struct HeadMotionTruth {
  double damping_rate_per_s = 8, stiffness_per_mass_per_s2 = 400, gain = 1, offset_m_s2 = 9;
  double position_sd_m = 5e-5, acceleration_sd_m_s2 = 0.05;
  double delay_s = 0;                           ///< of the accelerometer, at most a sample
  double amplitude_m = 0.01, frequency_Hz = 2;  ///< of the nods, whose strength and rate wander
  /// Force of muscles per mass (m/s^2) from head acceleration, velocity and position; may be empty.
  std::function<double(double, double, double)> muscles;
};

struct HeadMotionSample {
  double position_m = 0, acceleration_m_s2 = 0;  ///< measured; the latter reads weight as well
  double true_acceleration_m_s2 = 0;             ///< likewise
};

/// Integrates in steps so short that the head's acceleration may be linear in each.
class NoddingHead {
 public:
  NoddingHead(const HeadMotionTruth& truth, double rate_Hz, unsigned seed)
      : truth_(truth),
        T_s_(1 / rate_Hz / kSteps),
        rates_{truth.damping_rate_per_s, 1, truth.stiffness_per_mass_per_s2, truth.offset_m_s2},
        response_(driven_response(rates_, T_s_)),
        random_(seed) {}

  HeadMotionSample next() {
    const int steps = is_started_ ? kSteps : 1;
    for (int i = 0; i < steps; ++i) go();
    const double late_m_s2 = felt_m_s2_ - truth_.delay_s * rate_m_s3_;
    return {p_ + truth_.position_sd_m * normal_(random_),
            late_m_s2 / truth_.gain + truth_.acceleration_sd_m_s2 * normal_(random_), felt_m_s2_};
  }

 private:
  static constexpr int kSteps = 16;

  void go() {
    rate_ += 0.5 * T_s_ * (1 - rate_) + 0.15 * std::sqrt(T_s_) * normal_(random_);
    strength_ += 0.5 * T_s_ * (1 - strength_) + 0.25 * std::sqrt(T_s_) * normal_(random_);
    wander_ += 4 * T_s_ * (strength_ - wander_);
    sway_ += 4 * T_s_ * (rate_ - sway_);
    const double w = 2 * std::numbers::pi * truth_.frequency_Hz * sway_;
    phase_ += w * T_s_;
    constexpr double kWeight_m_s2 = 9.81;
    const double before_m_s2 = felt_m_s2_;
    felt_m_s2_ = kWeight_m_s2 - truth_.amplitude_m * wander_ * w * w *
                                    (std::sin(phase_) + 0.3 * std::sin(1.6 * phase_ + 1));
    double drive_m_s2 = -felt_m_s2_;
    if (truth_.muscles) drive_m_s2 += truth_.muscles(felt_m_s2_ - kWeight_m_s2, v_, p_ - rest_m_);
    if (is_started_) {
      const auto step = driven_step<double>(rates_, response_, p_, v_, before_m_s2_, drive_m_s2);
      p_ = step.position[kSolution];
      v_ = step.velocity[kSolution];
      rate_m_s3_ = (felt_m_s2_ - before_m_s2) / T_s_;
    } else {
      p_ = rest_m_ = (truth_.offset_m_s2 - kWeight_m_s2) / truth_.stiffness_per_mass_per_s2;
    }
    is_started_ = true;
    before_m_s2_ = drive_m_s2;
  }

  HeadMotionTruth truth_;
  double T_s_;
  DrivenRates<double> rates_;
  DrivenResponse<double> response_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double rate_ = 1, strength_ = 1, wander_ = 1, sway_ = 1;  // the latter two smooth
  double phase_ = 0, p_ = 0, v_ = 0, rest_m_ = 0, before_m_s2_ = 0;
  double felt_m_s2_ = 0, rate_m_s3_ = 0;
  bool is_started_ = false;
};

}  // namespace condyle::testing_support
