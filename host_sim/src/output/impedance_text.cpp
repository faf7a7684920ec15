// SPDX-License-Identifier: Apache-2.0
#include "output/impedance_text.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "output/replay_summary.h"

namespace condyle::host {

std::string limit_text(const IdentifiedValue<double>& value) {
  switch (value.limit) {
    case ImpedanceLimit::none:
    case ImpedanceLimit::mass_stated:  // of a known mass only
      return "";
    case ImpedanceLimit::no_drive:
      return ": no drive was measured while the position was";
    case ImpedanceLimit::too_slow:
      return ": the rate of positions or drive is too low; record at least 25 of each per second";
    case ImpedanceLimit::too_early:
      return ": too short; record 10 s of motion or more without a gap";
    case ImpedanceLimit::dynamics:
      return ": drive or position was smoothed or delayed; record both unfiltered";
    case ImpedanceLimit::noise:
      return ": drive and model do not explain the motion; another force acts, or drive or "
             "positions were smoothed";
    case ImpedanceLimit::changing:
      return ": the values, or the drive's delay, change along the recording; record for a shorter "
             "time, or state how they may vary in a parameter file";
    case ImpedanceLimit::drive_reversed:
      return ": the mass would be negative; the sign of the drive or of the axis is reversed";
    case ImpedanceLimit::implausible_mass:
      return ": the mass would be implausible (see drive unit)";
    case ImpedanceLimit::delay_stated:
      return ": the drive's delay differs from the stated one; correct --drive-delay-ms, or "
             "estimate the delay with --drive-fit-delay";
    case ImpedanceLimit::negative_friction:
      return ": friction would be negative; the drive is not the whole force";
    case ImpedanceLimit::excitation:
      return ": the motion is too weak or too uniform compared with the noise; chew, at several "
             "rhythms";
    case ImpedanceLimit::mass_or_stiffness:
      return ": this motion does not separate mass from stiffness; vary rhythm and height, or add "
             "faster strokes";
    case ImpedanceLimit::friction_or_delay:
      return ": this motion does not separate friction from the drive's delay; measure the delay, "
             "or chew at several rhythms";
    case ImpedanceLimit::viscous_or_coulomb:
      return ": this motion does not separate viscous from Coulomb friction; vary the speed";
    case ImpedanceLimit::resolution:
      return std::isfinite(value.needed_s)
                 ? fmt::format(
                       ": too little data for the stated resolution; about {:.0f} s of this motion "
                       "would suffice",
                       value.needed_s)
                 : ": too little data for the stated resolution; record longer, with larger motion";
    case ImpedanceLimit::gain:
      return ": the uncertainty of the drive's gain is too large for the stated resolution";
    case ImpedanceLimit::delay:
      return ": the uncertainty of the drive's delay, which acts like friction, is too large";
    case ImpedanceLimit::missing:
      return ": the drive may miss too much of the force (give --drive-missing SHARE, if known)";
    case ImpedanceLimit::smoothing:
      return ": the noise of drive or positions is not white, as after smoothing or with rounded "
             "time stamps; record both unfiltered, with times to 0.1 ms";
  }
  return "";
}

namespace {

// The unit of the drive that would give the mass closest to a jaw's.
std::string unit_text(double mass_kg, const ImpedanceParameters& parameters) {
  constexpr struct {
    double N;
    const char* name;
  } units[] = {{1e3, "kN"}, {9.80665, "kgf"}, {4.448222, "lbf"}, {0.00980665, "gf"}, {1e-3, "mN"}};
  constexpr double usual_kg = 0.25;
  double closest = std::numeric_limits<double>::infinity();
  std::string in_unit;
  for (const auto& unit : units) {
    const double kg = mass_kg * unit.N, apart = std::abs(std::log(kg / usual_kg));
    if (kg < parameters.least_mass_kg || kg > parameters.most_mass_kg || apart >= closest) continue;
    closest = apart;
    in_unit = fmt::format("; if the drive is in {}, it would be {:.2g} kg", unit.name, kg);
  }
  return fmt::format(
      "the mass would be {:.2g} kg, a jaw has {:g} to {:g} kg{}: check the units of drive_N and "
      "of the positions (another body: least_mass_kg, most_mass_kg)",
      mass_kg, parameters.least_mass_kg, parameters.most_mass_kg, in_unit);
}

// Signs of a wrong unit: a mass that few jaws have, a noise that few sensors have, or a noise far
// from the stated one.
constexpr double kUsualLeast_kg = 0.08, kUsualMost_kg = 1;
constexpr double kLeastNoise_N = 1e-4, kMostNoise_N = 1, kFarNoise = 4;

bool is_usual(const IdentifiedValue<double>& mass_kg) {
  return mass_kg.limit != ImpedanceLimit::none ||
         (mass_kg.fitted > kUsualLeast_kg && mass_kg.fitted < kUsualMost_kg);
}

std::string drive_noise_text(double noise_sd_N, double stated_sd_N) {
  const double times = noise_sd_N / stated_sd_N;
  const bool is_stated = stated_sd_N != DriveParameters{}.noise_sd_N;
  if (is_stated && (times > kFarNoise || times * kFarNoise < 1)) {
    return fmt::format("{:.2g} N, {:.2g} N was stated: is drive_N in N, and unfiltered?",
                       noise_sd_N, stated_sd_N);
  }
  if (noise_sd_N < kLeastNoise_N || noise_sd_N > kMostNoise_N) {
    return fmt::format("{:.2g} N, unusual for a sensor: is drive_N in N, and unfiltered?",
                       noise_sd_N);
  }
  return "";
}

}  // namespace

std::string impedance_text(const ImpedanceEstimate<double>& impedance,
                           const ImpedanceParameters& parameters) {
  const auto words = [](const IdentifiedValue<double>& value, const char* unit) {
    const std::string shown = value.limit == ImpedanceLimit::none
                                  ? ReplaySummary::with_interval(value.quantity, 1, unit, "95 %")
                                  : fmt::format("{:.4g} {}, assumed", value.quantity.value, unit);
    return shown + limit_text(value);
  };
  std::string text;
  ReplaySummary::add_line(text, "  friction", words(impedance.friction_Ns_m, "Ns/m"));
  ReplaySummary::add_line(text, "  mass", words(impedance.mass_kg, "kg"));
  ReplaySummary::add_line(text, "  stiffness", words(impedance.stiffness_N_m, "N/m"));
  ReplaySummary::add_line(text, "  offset", words(impedance.offset_N, "N"));
  if (parameters.coulomb_N.sd > 0) {
    ReplaySummary::add_line(text, "  Coulomb", words(impedance.coulomb_N, "N"));
  }
  if (parameters.delay == DelayModel::fitted) {
    ReplaySummary::add_line(text, "  delay", words(impedance.delay_s, "s"));
  }
  if (std::isfinite(impedance.residual_ratio)) {
    ReplaySummary::add_line(
        text, "drive model",
        fmt::format("residual {:.2f} times the noise (1 if drive and model explain the motion), "
                    "over {:.1f} s; noise of the drive {:.2g} N, of the positions {:.2g} mm, from "
                    "their differences",
                    impedance.residual_ratio, impedance.used_s, impedance.drive_noise_sd_N,
                    impedance.position_noise_sd_m * 1e3));
  }
  const DriveParameters& drive = parameters.drive;
  if (impedance.mass_kg.limit == ImpedanceLimit::implausible_mass) {
    ReplaySummary::add_line(text, "drive unit", unit_text(impedance.mass_kg.fitted, parameters));
  } else if (!is_usual(impedance.mass_kg)) {
    ReplaySummary::add_line(
        text, "drive unit",
        fmt::format("few jaws have such a mass ({:g} to {:g} kg): check the units of drive_N "
                    "and of the positions",
                    kUsualLeast_kg, kUsualMost_kg));
  }
  const std::string noise = drive_noise_text(impedance.drive_noise_sd_N, drive.noise_sd_N);
  if (!noise.empty()) ReplaySummary::add_line(text, "drive noise", noise);
  ReplaySummary::add_line(
      text, "assumes",
      fmt::format("drive in N, gain within {:g} %, axis within {:g} degrees; positions to scale "
                  "within {:g} %; delay {:g} +- {:g} ms; up to {:g} % of the force missing. Twice "
                  "the drive, or half the positions, makes friction and mass twice as large",
                  drive.gain_sd * 100, drive.axis_angle_sd_rad * 180 / std::numbers::pi,
                  drive.position_scale_sd * 100, drive.delay_s * 1e3, drive.delay_sd_s * 1e3,
                  drive.missing_share * 100));
  return text +
         "Friction is the effective damping along the followed axis, of joint, muscle and tissue "
         "together.\n";
}

}  // namespace condyle::host
