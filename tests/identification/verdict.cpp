// SPDX-License-Identifier: Apache-2.0
#include "identification/verdict.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <memory>

namespace condyle::adversary {
namespace {

void look(const IdentifiedValue<double>& value, double truth, Verdict& verdict) {
  verdict.limit = value.limit;
  verdict.is_shown = value.quantity.provenance == Provenance::measured;
  if (!verdict.is_shown) return;
  verdict.error = value.quantity.value - truth;
  verdict.sd = value.quantity.standard_deviation;
  verdict.is_covered = std::abs(verdict.error) <= kNormalQuantile95 * verdict.sd;
  verdict.was_covered = verdict.was_covered && verdict.is_covered;
}

}  // namespace

Verdict verdict_of(const IdentifiedValue<double>& value, double truth) {
  Verdict verdict;
  look(value, truth, verdict);
  return verdict;
}

Verdicts judge(const Attack& attack, std::uint64_t seed) {
  const Regime regime = drawn(attack, seed);
  const Recording recording = simulate(regime, seed);
  const double friction_Ns_m = effective_friction_Ns_m(regime, seed);
  const ImpedanceParameters parameters = parameters_of(attack.said);
  const auto identification = std::make_unique<PointIdentification<double>>(parameters);
  Verdicts verdicts;
  const auto look_now = [&] {
    const ImpedanceEstimate<double>& estimate = identification->estimate();
    look(estimate.friction_Ns_m, friction_Ns_m, verdicts.friction);
    look(estimate.mass_kg, regime.point.mass_kg, verdicts.mass);
  };
  std::size_t next = 0;
  double looked_s = 0;
  for (const Reading& position : recording.positions) {
    for (; next < recording.drive.size() && recording.drive[next].time_s <= position.time_s;
         ++next) {
      const Reading& drive = recording.drive[next];
      identification->add_drive(nanoseconds(drive.time_s), drive.value);
    }
    identification->add_position(nanoseconds(position.time_s), position.value);
    if (position.time_s - looked_s < 1) continue;
    looked_s = position.time_s;
    look_now();
  }
  for (; next < recording.drive.size(); ++next) {
    identification->add_drive(nanoseconds(recording.drive[next].time_s),
                              recording.drive[next].value);
  }
  identification->conclude();
  look_now();
  return verdicts;
}

void Tally::add(const Verdict& verdict) {
  ++runs;
  ++limits[static_cast<int>(verdict.limit)];
  always_covered += verdict.was_covered ? 1 : 0;
  if (!verdict.is_shown) return;
  ++shown;
  covered += verdict.is_covered ? 1 : 0;
  error_square += verdict.error * verdict.error;
  sd += verdict.sd;
}

std::string line_of(const char* name, const char* value, const Tally& tally) {
  std::string limits;
  for (std::size_t k = 1; k < kImpedanceLimits; ++k) {
    if (tally.limits[k] == 0) continue;
    limits += fmt::format("{}{} {}", limits.empty() ? "" : ", ",
                          limit_name(static_cast<ImpedanceLimit>(k)), tally.limits[k]);
  }
  return fmt::format("{:<34}{:<9}shown {:4d} of {:4d}, covered {:5.1f} %{}{}\n", name, value,
                     tally.shown, tally.runs, 100 * tally.covered_share(),
                     limits.empty() ? "" : "; withheld: ", limits);
}

std::string name_of(std::size_t index, const char* name) {
  std::string text = std::to_string(index) + '_';
  for (const char* c = name; *c != '\0'; ++c) {
    if (std::isalnum(static_cast<unsigned char>(*c)) != 0) text += *c;
  }
  return text;
}

}  // namespace condyle::adversary
