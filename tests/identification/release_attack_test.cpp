// SPDX-License-Identifier: Apache-2.0
// Passive releases of a simulator apart from release_samples.h (Runge-Kutta of a law with all that
// a release should not have): what is shown holds the truth, or nothing is shown. A row fails as in
// identification_test.cpp.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "condyle/estimator/release/passive_release.h"
#include "identification/verdict.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::adversary {
namespace {

using testing_support::fewest_hits;
using testing_support::runs;

struct Release {
  const char* name = "";
  double damping_per_s = 8, stiffness_per_s2 = 400, opening_m = 0.01;
  double rate_Hz = 60, duration_s = 0.6, noise_m = 5e-5;
  bool states_noise = true;
  double muscle_m_s2 = 0, muscle_s = 0.1;  ///< dies away with that time constant
  double let_go_s = 0;                     ///< over which the support goes, linear
  double fading_s = 0;                     ///< time constant of a support that fades away
  double hardening = 0;                    ///< of the spring at the opening
  double dry_m_s2 = 0;                     ///< sliding friction
  int mean_of = 1;
  double correlation = 0, jitter_s = 0;
  bool says_sudden = false;
  const char* cannot_be_had = nullptr;
};

struct Samples {
  std::vector<double> time_s, position_m;
};

Samples simulate(const Release& of, std::uint64_t seed) {
  Random random(seed);
  constexpr double kStep_s = 1e-4;
  const auto acceleration = [&](double t, double p, double v) {
    const double share = p / of.opening_m;
    const double support = of.stiffness_per_s2 * of.opening_m *
                           ((t < of.let_go_s ? 1 - t / of.let_go_s : 0) +
                            (of.fading_s > 0 ? std::exp(-t / of.fading_s) : 0));
    return -of.damping_per_s * v - of.stiffness_per_s2 * p * (1 + of.hardening * share * share) +
           support + of.muscle_m_s2 * std::exp(-t / of.muscle_s) -
           of.dry_m_s2 * v / std::sqrt(v * v + 1e-8);
  };
  double t = 0, p = of.opening_m, v = 0;
  const auto go_to = [&](double until_s) {
    while (t < until_s) {
      const double h = std::min(kStep_s, until_s - t);
      const double a1 = acceleration(t, p, v);
      const double a2 = acceleration(t + h / 2, p + h / 2 * v, v + h / 2 * a1);
      const double a3 = acceleration(t + h / 2, p + h / 2 * (v + h / 2 * a1), v + h / 2 * a2);
      const double a4 = acceleration(t + h, p + h * (v + h / 2 * a2), v + h * a3);
      p += h * v + h * h / 6 * (a1 + a2 + a3);
      v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
      t += h;
    }
  };
  Samples samples;
  std::vector<double> raw;
  double noise = random.normal();
  const double fresh = std::sqrt(1 - of.correlation * of.correlation);
  // Before the release the jaw is held, and the mean has it.
  for (int i = 1; i < of.mean_of; ++i) raw.push_back(of.opening_m + of.noise_m * random.normal());
  for (int i = 0; i <= of.duration_s * of.rate_Hz + 1e-9; ++i) {
    const double stamped_s = i / of.rate_Hz;
    go_to(std::max(t, stamped_s + of.jitter_s * random.normal()));
    noise = of.correlation * noise + fresh * random.normal();
    raw.push_back(p + of.noise_m * noise);
    double sum = 0;
    for (int k = 0; k < of.mean_of; ++k) sum += raw[raw.size() - 1 - static_cast<std::size_t>(k)];
    samples.time_s.push_back(stamped_s);
    samples.position_m.push_back(sum / of.mean_of);
  }
  return samples;
}

std::vector<Release> releases() {
  std::vector<Release> all;
  // kv/m of 8 1/s is measured in these; 40 1/s is not, but its intervals are printed.
  all.push_back({.name = "clean"});
  all.push_back({.name = "clean, noise not stated", .states_noise = false});
  all.push_back({.name = "clean 200 Hz", .rate_Hz = 200});
  all.push_back({.name = "clean 40 1/s", .damping_per_s = 40, .says_sudden = true});
  all.push_back({.name = "muscle 0.2 m/s^2 0.1 s", .muscle_m_s2 = 0.2});
  all.push_back({.name = "muscle 0.2 m/s^2 0.05 s", .muscle_m_s2 = 0.2, .muscle_s = 0.05});
  all.push_back({.name = "muscle 1 m/s^2 0.03 s", .muscle_m_s2 = 1, .muscle_s = 0.03});
  all.push_back(
      {.name = "muscle 1 m/s^2 0.03 s 200 Hz", .rate_Hz = 200, .muscle_m_s2 = 1, .muscle_s = 0.03});
  all.push_back({.name = "let go over 30 ms", .let_go_s = 0.03});
  all.push_back({.name = "let go over 60 ms", .let_go_s = 0.06});
  all.push_back({.name = "let go over 100 ms", .let_go_s = 0.1});
  all.push_back({.name = "let go over 100 ms, 40 1/s", .damping_per_s = 40, .let_go_s = 0.1});
  for (const double fading_s : {0.01, 0.02, 0.03, 0.05, 0.1}) {
    all.push_back({.name = "fades away", .fading_s = fading_s});
    all.push_back({.name = "fades away, 25 1/s",
                   .damping_per_s = 25,
                   .stiffness_per_s2 = 300,
                   .fading_s = fading_s});
    all.push_back({.name = "fades away, 40 1/s",
                   .damping_per_s = 40,
                   .stiffness_per_s2 = 300,
                   .opening_m = 0.02,
                   .noise_m = 2e-5,
                   .fading_s = fading_s});
  }
  all.push_back({.name = "muscle 0.5 m/s^2 0.2 s, 40 1/s",
                 .damping_per_s = 40,
                 .muscle_m_s2 = 0.5,
                 .muscle_s = 0.2,
                 .says_sudden = true});
  all.push_back({.name = "hardening 5 %", .hardening = 0.05});
  all.push_back({.name = "hardening 20 %", .hardening = 0.2});
  all.push_back({.name = "hardening 30 %, 40 1/s",
                 .damping_per_s = 40,
                 .hardening = 0.3,
                 .says_sudden = true});
  all.push_back({.name = "dry friction 0.02 m/s^2", .dry_m_s2 = 0.02});
  all.push_back({.name = "dry friction 0.04 m/s^2", .dry_m_s2 = 0.04});
  all.push_back({.name = "mean of 5", .mean_of = 5});
  all.push_back({.name = "mean of 5, not stated", .states_noise = false, .mean_of = 5});
  all.push_back({.name = "mean of 3", .mean_of = 3});
  all.push_back({.name = "mean of 3, not stated", .states_noise = false, .mean_of = 3});
  all.push_back({.name = "AR 0.5", .correlation = 0.5});
  all.push_back({.name = "AR 0.5, not stated", .states_noise = false, .correlation = 0.5});
  all.push_back({.name = "stamps 1 ms off", .jitter_s = 1e-3});
  all.push_back({.name = "stamps 1 ms off, not stated", .states_noise = false, .jitter_s = 1e-3});
  return all;
}

// Any interval is judged, that of a value that is only assumed too.
Verdict verdict_of(const ReleaseValue<double>& value, double truth) {
  Verdict verdict;
  verdict.is_shown = std::isfinite(value.quantity.value);
  if (!verdict.is_shown) return verdict;
  verdict.error = value.quantity.value - truth;
  verdict.sd = value.quantity.standard_deviation;
  verdict.is_covered = value.low95 <= truth && truth <= value.high95;
  return verdict;
}

class Released : public testing::TestWithParam<Release> {};

TEST_P(Released, IsCoveredOrWithheld) {
  const Release& of = GetParam();
  const int kRuns = runs(20, 40, 400);
  Tally damping, stiffness;
  int measured = 0;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const Samples samples = simulate(of, static_cast<std::uint64_t>(seed));
    const auto release = fit_passive_release<double>(
        samples.time_s, samples.position_m,
        {.noise_sd_m = of.states_noise ? of.noise_m : 0, .is_sudden = of.says_sudden});
    damping.add(verdict_of(release.damping_rate_per_s, of.damping_per_s));
    stiffness.add(verdict_of(release.stiffness_per_mass_per_s2, of.stiffness_per_s2));
    measured += release.damping_rate_per_s.quantity.provenance == Provenance::measured ? 1 : 0;
  }
  std::cout << line_of(of.name, "kv/m", damping)
            << fmt::format("  mean sd {:.3g}, measured {}\n", damping.sd / damping.shown, measured)
            << line_of(of.name, "ks/m", stiffness)
            << fmt::format("  mean sd {:.3g}\n", stiffness.sd / stiffness.shown);
  if (of.cannot_be_had != nullptr) return;
  for (const Tally& tally : {damping, stiffness}) {
    if (tally.shown < 0.03 * tally.runs) continue;
    EXPECT_GE(static_cast<std::uint64_t>(tally.covered),
              fewest_hits(static_cast<std::uint64_t>(tally.shown), 0.9, 1e-3));
  }
}
INSTANTIATE_TEST_SUITE_P(Attacks, Released, testing::ValuesIn(releases()),
                         [](const testing::TestParamInfo<Release>& test) {
                           return name_of(test.index, test.param.name);
                         });

}  // namespace
}  // namespace condyle::adversary
