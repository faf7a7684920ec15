// SPDX-License-Identifier: Apache-2.0
#include "protocols/release/release_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

using Json = nlohmann::ordered_json;
using Value = ReleaseValue<double>;

const char* explain(Provenance provenance) {
  return provenance == Provenance::measured ? "measured" : "assumed: too uncertain to be measured";
}

std::string line(const char* name, const char* unit, const Value& value) {
  const auto& [number, deviation, provenance] = value.quantity;
  if (provenance == Provenance::not_computed) {
    std::string bounds;
    if (std::isfinite(value.low95)) bounds += fmt::format(", above {:.4g}", value.low95);
    if (std::isfinite(value.high95)) bounds += fmt::format(", below {:.4g}", value.high95);
    return fmt::format("{:<20}NOT KNOWN{}{}\n", name,
                       bounds.empty() ? "" : bounds + (*unit != 0 ? fmt::format(" {}", unit) : ""),
                       bounds.empty() ? "" : " (95 %)");
  }
  const double low = value.low95, high = value.high95;
  return fmt::format("{:<20}{:<26}95 %: {:<20}{}\n", name,
                     fmt::format("{:.5g} {} (sd {:.2g})", number, unit, deviation),
                     fmt::format("{:.4g} to {:.4g}", low, high), explain(provenance));
}

Json json_of(const Value& value) {
  return {{"value", value.quantity.value},
          {"standard_deviation", value.quantity.standard_deviation},
          {"low_95", value.low95},
          {"high_95", value.high95},
          {"information", value.information},
          {"provenance", value.quantity.provenance == Provenance::not_computed
                             ? "not known"
                             : provenance_name(value.quantity.provenance)}};
}

const char* residuals_name(ReleaseResiduals residuals) {
  constexpr const char* names[] = {"as stated", "smaller", "larger",
                                   "coloured",  "driven",  "overdamped"};
  return names[static_cast<int>(residuals)];
}

// The problem and its remedy; empty if there is none.
std::string advice(const PassiveRelease<double>& fit) {
  switch (fit.residuals) {
    case ReleaseResiduals::as_stated:
      return "";
    case ReleaseResiduals::smaller:
      return fmt::format(
          "the noise is smaller than stated: intervals are too wide; --noise-mm {:.3g} would fit",
          1e3 * fit.residual_rms_m);
    case ReleaseResiduals::larger:
      return "the residuals are larger than the stated noise: this was not a release of a spring "
             "and a damper alone\n                    (a hand, a muscle, a contact, dry friction; "
             "start too early, end too late), or the noise is larger.\n                    NOTHING "
             "IS MEASURED; look at the figure (--figures), choose --begin-s and --end-s";
    case ReleaseResiduals::coloured:
      return "neighbouring residuals are correlated: smoothed positions, or not a release of a "
             "spring and a damper alone.\n                    NOTHING IS MEASURED; record without "
             "the manufacturer's filter, choose --begin-s and --end-s";
    case ReleaseResiduals::driven:
      return "kv/m below zero: something drove the jaw, so this was not a passive release.\n       "
             " "
             "            NOTHING IS MEASURED; relax the jaw, choose --begin-s and --end-s";
    case ReleaseResiduals::overdamped:
      return "the motion may be overdamped, but a hand that lets go slowly looks the same.\n"
             "                    NOTHING IS MEASURED; state --let-go-ms, or fix a known mass to "
             "the jaw, which lowers the damping ratio";
  }
  return "";
}

Json json_of(const FittedRelease& release) {
  const PassiveRelease<double>& fit = release.fit;
  Json json = {{"recording", clean_line(release.recording)},
               {"begin_s", release.stretch.time_s.front()},
               {"end_s", release.stretch.time_s.back()},
               {"samples", release.stretch.time_s.size()},
               {"damping_rate_per_s", json_of(fit.damping_rate_per_s)},
               {"stiffness_per_mass_per_s2", json_of(fit.stiffness_per_mass_per_s2)},
               {"damping_ratio", json_of(fit.damping_ratio)},
               {"natural_frequency_rad_s", json_of(fit.natural_frequency_rad_s)},
               {"natural_frequency_Hz", json_of(fit.natural_frequency_Hz)},
               {"rest_m", fit.rest_m},
               {"start_m", fit.start_m},
               {"start_velocity_m_s", fit.start_velocity_m_s},
               {"later_start_s", fit.later_start_s},
               {"noise_sd_m", fit.noise_sd_m},
               {"residual_rms_m", fit.residual_rms_m},
               {"residual_correlation", fit.residual_correlation},
               {"chi_square", fit.chi_square},
               {"degrees_of_freedom", fit.degrees_of_freedom},
               {"residuals", residuals_name(fit.residuals)}};
  return json;
}

std::string dump(Json json) {
  json["condyle"] = CONDYLE_VERSION;
  json["note"] = "research use only; not a diagnosis";
  return json.dump(2) + "\n";
}

}  // namespace

FittedRelease fit_release(const ReleaseSource& source, const ReleaseSettings& settings) {
  FittedRelease release{source.recording, read_release(source), {}, settings.noise_sd_m > 0};
  const auto& times = release.stretch.time_s;
  release.fit = fit_passive_release<double>(times, release.stretch.position_m, settings);
  const auto refuse = [&](const std::string& problem, const char* mend) {
    throw InputError(source.recording, problem, mend);
  };
  switch (release.fit.outcome) {
    case ReleaseOutcome::converged:
      break;
    case ReleaseOutcome::too_few_samples:
      refuse(fmt::format("{} samples in this part; a fit needs {}", times.size(),
                         kFewestReleaseSamples),
             "check --begin-s and --end-s, or record at a higher rate");
      break;
    case ReleaseOutcome::no_motion:
      refuse(fmt::format("no motion above the noise from {:.3f} to {:.3f} s", times.front(),
                         times.back()),
             "check --begin-s and the followed point and axis, or open wider before letting go");
      break;
    case ReleaseOutcome::not_converged:
      refuse(
          fmt::format("the motion from {:.3f} to {:.3f} s does not determine damping and stiffness",
                      times.front(), times.back()),
          "check --begin-s and --end-s; open wider, or record at a higher rate");
      break;
    case ReleaseOutcome::unusable_input:
    case ReleaseOutcome::times_unordered:
      refuse("contains positions or times that cannot be used", "check it with condyle replay");
      break;
  }
  return release;
}

std::string release_text(const FittedRelease& release) {
  const PassiveRelease<double>& fit = release.fit;
  std::string text = fmt::format("{:<20}{}\n", "recording", clean_line(release.recording));
  text += fmt::format("{:<20}{:.4f} to {:.4f} s ({}), {} samples\n", "release",
                      release.stretch.time_s.front(), release.stretch.time_s.back(),
                      release.stretch.was_found ? "start found" : "start as given",
                      release.stretch.time_s.size());
  text += line("kv/m", "1/s", fit.damping_rate_per_s);
  text += line("ks/m", "1/s^2", fit.stiffness_per_mass_per_s2);
  text += line("damping ratio", "", fit.damping_ratio);
  text += line("natural frequency", "Hz", fit.natural_frequency_Hz);
  text += fmt::format("{:<20}start {:.3f} mm, rest {:.3f} mm, velocity at the start {:.1f} mm/s\n",
                      "motion", 1e3 * fit.start_m, 1e3 * fit.rest_m, 1e3 * fit.start_velocity_m_s);
  text += fmt::format(
      "{:<20}rms {:.4f} mm, noise {:.4f} mm {}, chi-square {:.1f} of {} degrees of freedom, "
      "correlation {:.2f}: {}\n",
      "residuals", 1e3 * fit.residual_rms_m, 1e3 * fit.noise_sd_m,
      release.is_noise_stated ? "as stated" : "by these residuals", fit.chi_square,
      fit.degrees_of_freedom, fit.residual_correlation,
      fit.residuals == ReleaseResiduals::as_stated && !release.is_noise_stated
          ? "white"
          : residuals_name(fit.residuals));
  const std::string note = advice(fit);
  if (!note.empty()) text += fmt::format("{:<20}{}\n", "note", note);
  if (!release.is_noise_stated) {
    text += fmt::format(
        "{:<20}the noise was not stated (--noise-mm): the size of the residuals "
        "cannot reveal a wrong model\n",
        "note");
  }
  return text;
}

std::string release_json(const FittedRelease& release) {
  return dump(json_of(release));
}

std::string pair_text(const FittedRelease& first, const FittedRelease& second,
                      const ReleasePair<double>& pair) {
  std::string text = release_text(first) + "\n" + release_text(second) + "\n";
  switch (pair.outcome) {
    case ReleasePairOutcome::combined:
      text += line("kv", "Ns/m", pair.friction_Ns_m);
      text += line("ks", "N/m", pair.stiffness_N_m);
      text += line("m", "kg", pair.mass_kg);
      text += fmt::format("{:<20}chi-square {:.2f} of {} degrees of freedom: they agree\n",
                          "both recordings", pair.chi_square, pair.degrees_of_freedom);
      break;
    case ReleasePairOutcome::disagree:
      text += fmt::format(
          "kv, ks and m        NOT KNOWN: no single (kv, ks, m) explains both recordings "
          "(chi-square {:.1f} of {} degrees\n                    of freedom, above a chance of 1 "
          "in 1000); check the load, and that the jaw was relaxed both times\n",
          pair.chi_square, pair.degrees_of_freedom);
      break;
    case ReleasePairOutcome::release_not_known:
      text +=
          "kv, ks and m        NOT KNOWN: one of the releases has no reliable values, see above\n";
      break;
    case ReleasePairOutcome::unusable_load:
    case ReleasePairOutcome::not_converged:
      text += "kv, ks and m        NOT KNOWN: the recordings do not determine them\n";
      break;
  }
  return text;
}

std::string pair_json(const FittedRelease& first, const FittedRelease& second,
                      const ReleasePair<double>& pair) {
  constexpr const char* outcomes[] = {"combined", "release not known", "unusable load", "disagree",
                                      "not converged"};
  return dump({{"outcome", outcomes[static_cast<int>(pair.outcome)]},
               {"friction_Ns_m", json_of(pair.friction_Ns_m)},
               {"stiffness_N_m", json_of(pair.stiffness_N_m)},
               {"mass_kg", json_of(pair.mass_kg)},
               {"chi_square", pair.chi_square},
               {"degrees_of_freedom", pair.degrees_of_freedom},
               {"first", json_of(first)},
               {"second", json_of(second)}});
}

}  // namespace condyle::host
