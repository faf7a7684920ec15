// SPDX-License-Identifier: Apache-2.0
#include "protocols/release/release_plan.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace condyle::host {
namespace {

constexpr double kLongest_s = 10, kFarFromNormal = 0.15;

ReleaseRates<double> rates_of(const ReleasePlan& plan) {
  const double omega = 2 * std::numbers::pi * plan.natural_frequency_Hz;
  return {plan.damping_rate_per_s, omega * omega};
}

std::string row(const ReleasePlan& plan, double duration_s) {
  const auto deviations = expected_deviations(plan, duration_s);
  constexpr double kPerTurn = 1 / (2 * std::numbers::pi);
  return fmt::format("{:<12.3g}{:<14.3g}{:<16.3g}{:<16.3g}{:.3g}\n", duration_s,
                     deviations.damping_rate_per_s, deviations.stiffness_per_mass_per_s2,
                     deviations.damping_ratio, kPerTurn * deviations.natural_frequency_rad_s);
}

// Durations in steps of 5 %.
std::vector<double> durations(const ReleasePlan& plan) {
  std::vector<double> result;
  for (double d = 6 / plan.rate_Hz; d < 1.05 * kLongest_s; d *= 1.05) result.push_back(d);
  return result;
}

}  // namespace

ReleaseDeviations<double> expected_deviations(const ReleasePlan& plan, double duration_s) {
  std::vector<double> times;
  for (int i = 0; i <= duration_s * plan.rate_Hz + 1e-9; ++i) times.push_back(i / plan.rate_Hz);
  const auto rates = rates_of(plan);
  const auto bound =
      release_bound<double>(times, rates, 1e-3 * plan.opening_mm, 0, 1e-3 * plan.noise_mm, false);
  return release_deviations(bound, rates);
}

std::optional<ReleaseEffort> effort_for(const ReleasePlan& plan, double sd_per_s) {
  const auto deviation = [&](double d) { return expected_deviations(plan, d).damping_rate_per_s; };
  const double best = deviation(kLongest_s);
  if (!std::isfinite(best)) return std::nullopt;
  for (const double d : durations(plan)) {
    const double sd = deviation(d);
    if (sd <= sd_per_s) return ReleaseEffort{d, 1};
    if (best > sd_per_s && sd <= 1.05 * best) {
      return ReleaseEffort{d, std::ceil(std::pow(sd / sd_per_s, 2))};
    }
  }
  return std::nullopt;
}

std::string plan_text(const ReleasePlan& plan) {
  const auto rates = rates_of(plan);
  std::string text = fmt::format(
      "Passive release at {:g} Hz, noise {:g} mm, released {:g} mm from rest; kv/m = {:g} 1/s, "
      "natural frequency {:g} Hz\n(ks/m = {:.4g} 1/s^2, damping ratio {:.3g}). Research use only.\n"
      "Expected standard deviation (the Cramer-Rao bound; rest, start and its velocity "
      "unknown):\n\n",
      plan.rate_Hz, plan.noise_mm, plan.opening_mm, plan.damping_rate_per_s,
      plan.natural_frequency_Hz, rates.kappa, rates.lambda / (2 * std::sqrt(rates.kappa)));
  text += fmt::format("{:<12}{:<14}{:<16}{:<16}{}\n", "seconds", "kv/m (1/s)", "ks/m (1/s^2)",
                      "damping ratio", "natural frequency (Hz)");
  text += row(plan, plan.duration_s) + "\n";
  for (const double factor : {0.5, 1.5, 2.0, 4.0}) text += row(plan, factor * plan.duration_s);

  text +=
      "\nThe intervals of a recording are about three times as wide, far wider if kv/m is above "
      "20: they include what a\nlater start of the fit changes, so that a hand that still acts is "
      "covered.\n";
  const double sd = expected_deviations(plan, plan.duration_s).damping_rate_per_s;
  if (!std::isfinite(sd)) {
    text += "\nToo few samples: a release needs more than five, with motion.\n";
  } else if (sd > kFarFromNormal * plan.damping_rate_per_s) {
    text += fmt::format(
        "\nSo uncertain ({:.0f} %) that a fit will do worse than this bound, or give no upper "
        "end.\n"
        "Open wider, record at a higher rate or with less noise.\n",
        100 * sd / plan.damping_rate_per_s);
  }
  if (!plan.wanted_damping_rate_sd_per_s) return text;
  const double wanted = *plan.wanted_damping_rate_sd_per_s;
  const auto effort = effort_for(plan, wanted);
  text += fmt::format("\nFor kv/m to +- {:g} 1/s: ", wanted);
  if (!effort) {
    text += "no release of this kind determines it.\n";
  } else if (effort->releases == 1) {
    text += fmt::format("one release of {:.2g} s.\n", effort->duration_s);
  } else {
    text += fmt::format(
        "the mean of {:g} releases of {:.2g} s; longer recordings gain less than 5 %.\n",
        effort->releases, effort->duration_s);
  }
  return text;
}

}  // namespace condyle::host
