// SPDX-License-Identifier: Apache-2.0
#include "protocols/head_motion/head_motion_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace condyle::host {
namespace {

// Shorter ones give no conclusion.
const double kShortest_s =
    PointConclusion<double>::kFewestBlocks * RegressionBlocks<double>::kFirstBlock_s;

double square(double value) {
  return value * value;
}

std::string row(const HeadMotionDeviations& sd) {
  return fmt::format("{:<12.4g}{:<14.3g}{:<16.3g}{:<24.3g}{:.3g}\n", sd.duration_s,
                     sd.damping_rate_by_noise, sd.stiffness_by_noise, sd.damping_rate_per_s,
                     sd.stiffness_per_mass_per_s2);
}

}  // namespace

HeadMotionDeviations expected_deviations(const HeadMotionPlan& plan, double duration_s) {
  const double w = 2 * std::numbers::pi * plan.frequency_Hz, lambda = plan.damping_rate_per_s,
               kappa = square(2 * std::numbers::pi * plan.natural_frequency_Hz),
               T = 1 / plan.rate_Hz;
  const double response2 = square(kappa - w * w) + square(lambda * w);
  const double a = 1e-3 * plan.amplitude_mm * w * w / std::numbers::sqrt2,
               X = a / std::sqrt(response2), V = w * X;
  const double S =
      T * (square(plan.acceleration_noise_sd_m_s2) + square(1e-3 * plan.noise_mm) * response2);
  const HeadMotionParameters& stated = plan.stated;
  const double scale2 = square(stated.gain_sd) + square(stated.lever_sd),
               muscles = stated.muscle_share * a;
  HeadMotionDeviations sd{duration_s};
  sd.damping_rate_by_noise = std::sqrt(S / duration_s) / V;
  sd.stiffness_by_noise = std::sqrt(S / duration_s) / X;
  sd.damping_rate_per_s =
      std::sqrt(square(sd.damping_rate_by_noise) + square((kappa - w * w) * stated.delay_sd_s) +
                scale2 * square(lambda) + square(muscles / V));
  sd.stiffness_per_mass_per_s2 =
      std::sqrt(square(sd.stiffness_by_noise) + square(lambda * w * w * stated.delay_sd_s) +
                scale2 * square(kappa - w * w) + square(muscles / X));
  return sd;
}

std::optional<double> duration_for(const HeadMotionPlan& plan, double sd_per_s) {
  const HeadMotionDeviations sd = expected_deviations(plan, 1);
  const double noise2 = square(sd.damping_rate_by_noise),
               rest2 = square(sd_per_s) - (square(sd.damping_rate_per_s) - noise2);
  if (!(rest2 > 0)) return std::nullopt;
  return std::max(noise2 / rest2, kShortest_s);
}

std::string plan_text(const HeadMotionPlan& plan) {
  const double omega = 2 * std::numbers::pi * plan.natural_frequency_Hz;
  std::string text = fmt::format(
      "Head motion of {:g} mm at {:g} Hz, recorded at {:g} Hz; noise {:g} mm and {:g} m/s^2, gain "
      "+- {:g}, delay +- {:g} ms,\nmuscles {:g} of the inertial force; kv/m = {:g} 1/s, ks/m = "
      "{:.4g} 1/s^2. Research use only.\nExpected standard deviation (the Cramer-Rao bound of this "
      "motion):\n\n",
      plan.amplitude_mm, plan.frequency_Hz, plan.rate_Hz, plan.noise_mm,
      plan.acceleration_noise_sd_m_s2, plan.stated.gain_sd, 1e3 * plan.stated.delay_sd_s,
      plan.stated.muscle_share, plan.damping_rate_per_s, omega * omega);
  text += fmt::format("{:<12}{:<14}{:<16}{}\n", "", "from noise", "",
                      "with gain, delay and muscles as stated");
  text += fmt::format("{:<12}{:<14}{:<16}{:<24}{}\n", "seconds", "kv/m (1/s)", "ks/m (1/s^2)",
                      "kv/m (1/s)", "ks/m (1/s^2)");
  text += row(expected_deviations(plan, plan.duration_s)) + "\n";
  for (const double factor : {0.5, 2.0, 4.0}) {
    text += row(expected_deviations(plan, factor * plan.duration_s));
  }
  text +=
      "\nThe intervals of a recording are about 1.2 times as wide, because they use its own "
      "scatter.\n";
  if (!plan.wanted_damping_rate_sd_per_s) return text;
  const double wanted = *plan.wanted_damping_rate_sd_per_s;
  const auto duration_s = duration_for(plan, wanted);
  if (duration_s)
    return text + fmt::format("For kv/m to +- {:g} 1/s: {:.1f} s.\n", wanted, *duration_s);
  return text + fmt::format(
                    "For kv/m to +- {:g} 1/s: no duration suffices; move the head more, or reduce "
                    "the uncertainty of gain, delay and muscles.\n",
                    wanted);
}

}  // namespace condyle::host
