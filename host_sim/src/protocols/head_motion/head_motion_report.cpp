// SPDX-License-Identifier: Apache-2.0
#include "protocols/head_motion/head_motion_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hosted/files/clean_text.h"
#include "output/gnuplot.h"
#include "recordings/recording_files.h"

namespace condyle::host {
namespace {

using Json = nlohmann::ordered_json;
using Value = IdentifiedValue<double>;

// Why a value is not measured, and the remedy.
const char* reason(ImpedanceLimit limit) {
  switch (limit) {
    case ImpedanceLimit::no_drive:
      return "no acceleration accompanies the positions";
    case ImpedanceLimit::too_slow:
      return "the rate of positions or accelerations is too low; record at least 25 of each per "
             "second";
    case ImpedanceLimit::too_early:
      return "too short; record 10 s of motion or more without a gap";
    case ImpedanceLimit::noise:
      return "the head's motion does not explain the jaw's: a muscle, a hand or a contact acts, "
             "the "
             "head turns, or one of them was smoothed";
    case ImpedanceLimit::dynamics:
      return "accelerometer or tracker was smoothed or delayed; record both unfiltered";
    case ImpedanceLimit::mass_stated:
      return "the gain in the motion differs from the calibration: the head rotates, muscles act, "
             "or the accelerometer is along another axis (--acceleration-gain-sd, --lever-sd)";
    case ImpedanceLimit::delay_stated:
      return "the acceleration's delay differs from the stated one (--acceleration-delay-ms)";
    case ImpedanceLimit::changing:
      return "damping, or the acceleration's delay, changes along the recording; record for a "
             "shorter time";
    case ImpedanceLimit::negative_friction:
      return "damping would be negative: muscles drive the jaw, or the acceleration has the wrong "
             "sign";
    case ImpedanceLimit::excitation:
    case ImpedanceLimit::mass_or_stiffness:
      return "the motion is too weak or too uniform; nod more, at several rhythms";
    case ImpedanceLimit::viscous_or_coulomb:
      return "the motion does not separate damping from a force that only changes direction, such "
             "as Coulomb friction or bursts of a muscle; vary the speed";
    case ImpedanceLimit::gain:
      return "the uncertainty of the accelerometer's gain is too large (--acceleration-gain-sd, "
             "--lever-sd)";
    case ImpedanceLimit::delay:
      return "the uncertainty of the acceleration's delay is too large "
             "(--acceleration-delay-sd-ms)";
    case ImpedanceLimit::missing:
      return "muscles may add too much; the jaw must be relaxed (give --muscle-share SHARE, if "
             "known)";
    case ImpedanceLimit::smoothing:
      return "the noise of accelerations or positions is not white, as after smoothing or with "
             "rounded time stamps; record both unfiltered, with times to 0.1 ms";
    default:
      return "too uncertain for the stated resolution; record longer, or move the head more";
  }
}

// True if the interval contains the value, regardless of its width.
bool has_interval(const Value& value) {
  return !is_failure(value.limit) && std::isfinite(value.fitted_sd);
}

std::pair<double, double> interval(const Value& value) {
  const double half = kNormalQuantile95 * value.fitted_sd;
  return {value.fitted - half, value.fitted + half};
}

std::string line(const char* name, const char* unit, const Value& value) {
  const auto [low, high] = interval(value);
  if (value.limit == ImpedanceLimit::none) {
    return fmt::format("{:<20}{:<26}95 %: {:<20}measured\n", name,
                       fmt::format("{:.5g} {} (sd {:.2g})", value.fitted, unit, value.fitted_sd),
                       fmt::format("{:.4g} to {:.4g}", low, high));
  }
  const std::string bounds =
      has_interval(value) ? fmt::format(" (95 %: {:.3g} to {:.3g} {})", low, high, unit) : "";
  return fmt::format("{:<20}NOT KNOWN{}: {}\n", name, bounds, reason(value.limit));
}

Json json_of(const Value& value) {
  const bool is_known = value.limit == ImpedanceLimit::none;
  const auto [low, high] = interval(value);
  const auto number = [](bool is_shown, double shown) { return is_shown ? Json(shown) : Json(); };
  return {{"value", number(is_known, value.fitted)},
          {"standard_deviation", number(is_known, value.fitted_sd)},
          {"low_95", number(has_interval(value), low)},
          {"high_95", number(has_interval(value), high)},
          {"provenance", is_known ? provenance_name(value.quantity.provenance) : "not known"},
          {"limit", limit_name(value.limit)}};
}

// " (A stated)" if the stated noise differs.
std::string unlike(double noise, const std::optional<double>& stated, double shown_per_si) {
  constexpr double kFar = 1.5;
  if (!stated || (noise < kFar * *stated && noise * kFar > *stated)) return "";
  return fmt::format(" ({:.2g} stated: smoothed, or not white?)", *stated * shown_per_si);
}

std::string block(const IdentifiedHeadMotion& motion) {
  std::string text = "$course << EOD\n";
  for (const HeadMotionPoint& point : motion.course) {
    text += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", point.time_s,
                        point.damping_rate_per_s, kNormalQuantile95 * point.damping_rate_sd,
                        point.stiffness_per_mass_per_s2, kNormalQuantile95 * point.stiffness_sd);
  }
  return text + "EOD\n";
}

// The second half determines the vertical range.
std::string range_of(const IdentifiedHeadMotion& motion, double HeadMotionPoint::*value,
                     double HeadMotionPoint::*deviation) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (std::size_t i = motion.course.size() / 2; i < motion.course.size(); ++i) {
    const HeadMotionPoint& point = motion.course[i];
    low = std::min(low, point.*value - 5 * point.*deviation);
    high = std::max(high, point.*value + 5 * point.*deviation);
  }
  if (!(high > low)) return "set yrange [*:*]\n";
  return fmt::format("set yrange [{:.6g}:{:.6g}]\n", low, high);
}

}  // namespace

std::string head_motion_text(const IdentifiedHeadMotion& motion) {
  const HeadMotionEstimate<double>& estimate = motion.estimate;
  const HeadMotionParameters& stated = motion.parameters;
  std::string text = fmt::format(
      "{:<20}{}, {} positions with an acceleration{}\n", "recording", clean_line(motion.recording),
      motion.taken,
      motion.counts.drive_gaps > 0 ? fmt::format(", {} gaps", motion.counts.drive_gaps) : "");
  const bool is_judged = std::isfinite(estimate.residual_ratio);
  if (is_judged) {
    text += fmt::format("{:<20}acceleration {:.3g} m/s^2, jaw {:.3g} mm and {:.3g} mm/s, rms\n",
                        "motion", estimate.rms_acceleration_m_s2, 1e3 * estimate.rms_position_m,
                        1e3 * estimate.rms_velocity_m_s);
  }
  text += fmt::format("{:<20}sd of gain {:.3g}, lever {:.3g}, delay {:.3g} ms; muscles {}\n",
                      "assumes", stated.gain_sd, stated.lever_sd, 1e3 * stated.delay_sd_s,
                      stated.muscle_share < 1
                          ? fmt::format("up to {:g} of the inertial force", stated.muscle_share)
                          : "not known");
  text += line("kv/m", "1/s", estimate.damping_rate_per_s);
  text += line("ks/m", "1/s^2", estimate.stiffness_per_mass_per_s2);
  text += fmt::format("{:<20}{}; the mass cancels and is not determined\n", "gain",
                      std::isfinite(estimate.gain_sd)
                          ? fmt::format("from the motion: {:.4g} (sd {:.2g}) of the stated",
                                        estimate.gain, estimate.gain_sd)
                          : "as stated: the motion does not determine it");
  if (is_judged) {
    text += fmt::format(
        "{:<20}{:.2f} times the noise (1 if the model holds); noise from their differences: "
        "positions {:.2g} mm{}, acceleration {:.2g} m/s^2{}\n",
        "residual", estimate.residual_ratio, 1e3 * estimate.position_noise_sd_m,
        unlike(estimate.position_noise_sd_m, motion.stated_noise_sd_m, 1e3),
        estimate.acceleration_noise_sd_m_s2,
        unlike(estimate.acceleration_noise_sd_m_s2, motion.stated_acceleration_noise_sd_m_s2, 1));
  }
  return text +
         "A relaxed jaw is assumed: the response of muscles to the motion looks like damping "
         "or "
         "stiffness.\n";
}

std::string head_motion_json(const IdentifiedHeadMotion& motion) {
  const HeadMotionEstimate<double>& estimate = motion.estimate;
  const Json json = {{"recording", clean_line(motion.recording)},
                     {"positions", motion.taken},
                     {"damping_rate_per_s", json_of(estimate.damping_rate_per_s)},
                     {"stiffness_per_mass_per_s2", json_of(estimate.stiffness_per_mass_per_s2)},
                     {"gain", estimate.gain},
                     {"gain_sd", estimate.gain_sd},
                     {"residual_ratio", estimate.residual_ratio},
                     {"rms_acceleration_m_s2", estimate.rms_acceleration_m_s2},
                     {"rms_position_m", estimate.rms_position_m},
                     {"rms_velocity_m_s", estimate.rms_velocity_m_s},
                     {"noise_sd_m", estimate.position_noise_sd_m},
                     {"acceleration_noise_sd_m_s2", estimate.acceleration_noise_sd_m_s2},
                     {"muscle_share", motion.parameters.muscle_share},
                     {"condyle", CONDYLE_VERSION},
                     {"note", "research use only; not a diagnosis"}};
  return json.dump(2) + "\n";
}

std::vector<std::unique_ptr<OutputFile>> draw_head_motion(const std::string& directory,
                                                          const IdentifiedHeadMotion& motion) {
  Gnuplot gnuplot(directory);
  gnuplot.send(block(motion));
  const bool is_measured = motion.estimate.damping_rate_per_s.limit == ImpedanceLimit::none;
  const std::string title = fmt::format("Head motion, {}{}", recording_name(motion.recording),
                                        is_measured ? "" : ": kv/m NOT KNOWN");
  const char* const style =
      is_measured ? "lw 1.8 lc rgb '#0b559f'" : "lw 1.8 dt 2 lc rgb '#606060'";
  const auto curve = [&](int column, const char* name) {
    return fmt::format(
        "plot $course using 1:(${0}-${1}):(${0}+${1}) with filledcurves lc rgb '{2}' title '95 % "
        "interval', $course using 1:{0} with lines {3} title '{4}'\n",
        column, column + 1, is_measured ? "#c6dbef" : "#dddddd", style, name);
  };
  gnuplot.draw(
      "head_motion",
      "set multiplot\nset lmargin 10\nset rmargin 3\nset key right top\n"
      "set origin 0,0.48\nset size 1,0.52\n" +
          title_command(title, "font ',11'") + "set ylabel 'kv/m (1/s)'\nset format x ''\n" +
          "unset xlabel\n" +
          range_of(motion, &HeadMotionPoint::damping_rate_per_s,
                   &HeadMotionPoint::damping_rate_sd) +
          curve(2, "kv/m so far") +
          "set origin 0,0\nset size 1,0.5\nunset title\nset ylabel 'ks/m (1/s^2)'\nset format x\n"
          "set xlabel 'time since the first sample (s)'\n" +
          range_of(motion, &HeadMotionPoint::stiffness_per_mass_per_s2,
                   &HeadMotionPoint::stiffness_sd) +
          curve(4, "ks/m so far") + "unset multiplot",
      840, 560);
  return gnuplot.finish();
}

}  // namespace condyle::host
