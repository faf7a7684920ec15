// SPDX-License-Identifier: Apache-2.0
#include "head_motion_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace condyle::host {
namespace {

constexpr double kLongest_s = 900;

// The filter along the motion, without noise and from the truth, so that its covariance is that of
// a filter that has found it.
class PlannedMotion {
 public:
  explicit PlannedMotion(const HeadMotionPlan& plan)
      : plan_(plan),
        T_s_(1 / plan.rate_Hz),
        omega_rad_s_(2 * std::numbers::pi * plan.natural_frequency_Hz),
        rates_{plan.damping_rate_per_s, 1, omega_rad_s_ * omega_rad_s_, 0},
        response_(driven_response(rates_, T_s_)),
        stage_(at_truth(plan, rates_)) {}

  void step() {
    const double w = 2 * std::numbers::pi * plan_.frequency_Hz;
    const double now_m_s2 = -1e-3 * plan_.amplitude_mm * w * w * std::sin(w * T_s_ * steps_);
    if (steps_ > 0) {
      const auto moved = driven_step<double>(rates_, response_, p_, v_, -before_m_s2_, -now_m_s2);
      p_ = moved.position[kSolution];
      v_ = moved.velocity[kSolution];
    }
    before_m_s2_ = now_m_s2;
    stage_.accelerate(steps_ > 0 ? T_s_ : 0, now_m_s2);
    stage_.measure(1, p_, 1e-3 * plan_.noise_mm);
    ++steps_;
  }
  double time_s() const { return T_s_ * steps_; }
  HeadMotionDeviations deviations() const {
    const auto estimate = stage_.estimate();
    const IdentifiedValue<double>& damping = estimate.damping_rate_per_s;
    const IdentifiedValue<double>& stiffness = estimate.stiffness_per_mass_per_s2;
    return {time_s(), damping.sampling_sd, stiffness.sampling_sd, damping.fitted_sd,
            stiffness.fitted_sd};
  }

 private:
  static HeadMotionParameters at_truth(const HeadMotionPlan& plan,
                                       const DrivenRates<double>& rates) {
    HeadMotionParameters parameters = plan.stated;
    parameters.damping_rate_per_s.mean = rates.lambda;
    parameters.stiffness_per_mass_per_s2.mean = rates.kappa;
    return parameters;
  }

  const HeadMotionPlan& plan_;
  double T_s_, omega_rad_s_;
  DrivenRates<double> rates_;
  DrivenResponse<double> response_;
  HeadMotionIdentification<double> stage_;
  int steps_ = 0;
  double p_ = 0, v_ = 0, before_m_s2_ = 0;
};

std::string row(const HeadMotionDeviations& sd) {
  return fmt::format("{:<12.4g}{:<14.3g}{:<16.3g}{:<24.3g}{:.3g}\n", sd.duration_s,
                     sd.damping_rate_by_filter, sd.stiffness_by_filter, sd.damping_rate_per_s,
                     sd.stiffness_per_mass_per_s2);
}

}  // namespace

HeadMotionDeviations expected_deviations(const HeadMotionPlan& plan, double duration_s) {
  PlannedMotion motion(plan);
  while (motion.time_s() < duration_s) motion.step();
  return motion.deviations();
}

std::optional<double> duration_for(const HeadMotionPlan& plan, double sd_per_s) {
  PlannedMotion motion(plan);
  constexpr double kFirst_s = 1, kEvery_s = 0.1;
  for (double next_s = kFirst_s; next_s <= kLongest_s; next_s += kEvery_s) {
    while (motion.time_s() < next_s) motion.step();
    const HeadMotionDeviations sd = motion.deviations();
    if (sd.damping_rate_per_s <= sd_per_s) return next_s;
    // What no duration averages out, once the motion is in its stride.
    const double granted =
        std::sqrt(std::max(sd.damping_rate_per_s * sd.damping_rate_per_s -
                               sd.damping_rate_by_filter * sd.damping_rate_by_filter,
                           0.0));
    if (next_s > 60 && granted > sd_per_s) return std::nullopt;
  }
  return std::nullopt;
}

std::string plan_text(const HeadMotionPlan& plan) {
  const double omega = 2 * std::numbers::pi * plan.natural_frequency_Hz;
  std::string text = fmt::format(
      "Head motion of {:g} mm at {:g} Hz, recorded at {:g} Hz; noise {:g} mm and {:g} m/s^2, gain "
      "+- {:g}, delay +- {:g} ms,\nmuscles {:g} of the inertial force; kv/m = {:g} 1/s, ks/m = "
      "{:.4g} 1/s^2. Research use only.\nStandard deviation to expect (the filter's covariance "
      "along this motion, which nears the Cramer-Rao bound):\n\n",
      plan.amplitude_mm, plan.frequency_Hz, plan.rate_Hz, plan.noise_mm,
      plan.stated.acceleration_noise_sd_m_s2, plan.stated.gain_sd, 1e3 * plan.stated.delay_sd_s,
      plan.stated.muscle_share, plan.damping_rate_per_s, omega * omega);
  text += fmt::format("{:<12}{:<14}{:<16}{}\n", "", "by the noise", "",
                      "with delay and muscles as stated");
  text += fmt::format("{:<12}{:<14}{:<16}{:<24}{}\n", "seconds", "kv/m (1/s)", "ks/m (1/s^2)",
                      "kv/m (1/s)", "ks/m (1/s^2)");
  text += row(expected_deviations(plan, plan.duration_s)) + "\n";
  for (const double factor : {0.5, 2.0, 4.0}) {
    text += row(expected_deviations(plan, factor * plan.duration_s));
  }
  text +=
      "\nThis is one frequency, at which the gain is known by its calibration only; a rhythm that "
      "varies tells more.\n";
  if (!plan.wanted_damping_rate_sd_per_s) return text;
  const double wanted = *plan.wanted_damping_rate_sd_per_s;
  const auto duration_s = duration_for(plan, wanted);
  if (duration_s)
    return text + fmt::format("For kv/m to +- {:g} 1/s: {:.1f} s.\n", wanted, *duration_s);
  return text + fmt::format(
                    "For kv/m to +- {:g} 1/s: no duration reaches it; move the head more, or "
                    "learn more of gain, delay and muscles.\n",
                    wanted);
}

}  // namespace condyle::host
