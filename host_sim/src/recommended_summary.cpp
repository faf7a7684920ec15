// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "replay_summary.h"

namespace condyle::host {
namespace {

// Why a value is not measured, and what would show it.
std::string limit_words(const IdentifiedValue<double>& value) {
  switch (value.limit) {
    case JointLimit::none:
    case JointLimit::mass_stated:  // of a known mass only
      return "";
    case JointLimit::no_drive:
      return ": no drive was measured while the position was";
    case JointLimit::too_slow:
      return ": positions or drive come too seldom; record at least 25 of each a second";
    case JointLimit::too_early:
      return ": too short to judge by; record 10 s of motion or more without a gap";
    case JointLimit::dynamics:
      return ": drive or position was smoothed or follows late; record both unfiltered";
    case JointLimit::noise:
      return ": drive and model leave more than noise; another force acts, or drive or positions "
             "were smoothed";
    case JointLimit::changing:
      return ": the values, or the drive's delay, change along the recording; record shorter, or "
             "state how they may walk in a parameter file";
    case JointLimit::drive_reversed:
      return ": the mass would be negative; the sign of the drive or of the axis is reversed";
    case JointLimit::implausible_mass:
      return ": the mass would be implausible (see drive unit)";
    case JointLimit::delay_stated:
      return ": the drive's delay is not what is stated; state --drive-delay-ms, or estimate it "
             "with --drive-fit-delay";
    case JointLimit::negative_friction:
      return ": friction would be negative; the drive is not all "
             "of the force";
    case JointLimit::excitation:
      return ": the motion is too weak or too uniform against the noise; chew, at several rhythms";
    case JointLimit::mass_or_stiffness:
      return ": this motion cannot tell mass from the spring; let rhythm and height vary, or add "
             "faster strokes";
    case JointLimit::friction_or_delay:
      return ": this motion cannot tell friction from the drive's delay; measure the delay, or "
             "chew at several rhythms";
    case JointLimit::viscous_or_coulomb:
      return ": this motion cannot tell viscous from sliding friction; let its speed vary";
    case JointLimit::resolution:
      return std::isfinite(value.needed_s)
                 ? fmt::format(
                       ": too little for the stated resolution; about {:.0f} s of this "
                       "motion would do",
                       value.needed_s)
                 : ": too little for the stated resolution; record longer, with larger motion";
    case JointLimit::gain:
      return ": the uncertainty of the drive's gain is too large for the stated resolution";
    case JointLimit::delay:
      return ": the uncertainty of the drive's delay, which acts like friction, is too large";
    case JointLimit::missing:
      return ": the drive may miss too much of the force (--drive-missing SHARE, if that is known)";
  }
  return "";
}

// In which unit the drive would give the mass that is nearest to a jaw's.
std::string unit_words(double mass_kg, const JointParameters& parameters) {
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
    in_unit = fmt::format("; were the drive in {}, it would be {:.2g} kg", unit.name, kg);
  }
  return fmt::format(
      "the mass would be {:.2g} kg, a jaw has {:g} to {:g} kg{}: check the units of drive_N and "
      "of the positions (another body: least_mass_kg, most_mass_kg)",
      mass_kg, parameters.least_mass_kg, parameters.most_mass_kg, in_unit);
}

// What speaks of a wrong unit without proving it: a mass that few jaws have, a noise that few
// sensors have, or one that is far from what was stated.
constexpr double kUsualLeast_kg = 0.08, kUsualMost_kg = 1;
constexpr double kLeastNoise_N = 1e-4, kMostNoise_N = 1, kFarNoise = 4;

bool is_usual(const IdentifiedValue<double>& mass_kg) {
  return mass_kg.limit != JointLimit::none ||
         (mass_kg.fitted > kUsualLeast_kg && mass_kg.fitted < kUsualMost_kg);
}

std::string drive_noise_words(double noise_sd_N, double stated_sd_N) {
  const double times = noise_sd_N / stated_sd_N;
  const bool is_stated = stated_sd_N != DriveParameters{}.noise_sd_N;
  if (is_stated && (times > kFarNoise || times * kFarNoise < 1)) {
    return fmt::format("{:.2g} N, {:.2g} N was stated: is drive_N in N, and unfiltered?",
                       noise_sd_N, stated_sd_N);
  }
  if (noise_sd_N < kLeastNoise_N || noise_sd_N > kMostNoise_N) {
    return fmt::format("{:.2g} N, which few sensors have: is drive_N in N, and unfiltered?",
                       noise_sd_N);
  }
  return "";
}

}  // namespace

void RecommendedSummary::add(const EstimateRow& row) {
  ReplaySummary::add(row);
  const double step_s =
      last_step_ns_ ? seconds(*last_step_ns_) : std::numeric_limits<double>::quiet_NaN();
  if (is_told_twice(row)) return;
  const bool is_rejected = row.events.has(Event::outlier_rejected);
  for (int i = 0; i < row.axis_count; ++i) {
    watches_[i].add(standardised_innovation(row, i),
                    is_rejected ? EstimateRow::kNone : row.axes[i].measured_position_m, step_s);
  }
}

std::string RecommendedSummary::per_axis(const char* format,
                                         double (*value)(const RecommendedSummary&, int)) const {
  std::string text;
  for (int axis = 0; axis < axis_count(); ++axis) {
    if (axis > 0) text += ", ";
    if (axis_count() == 3) text += fmt::format("{} ", "xyz"[axis]);
    text += fmt::format(fmt::runtime(format), value(*this, axis));
  }
  return text;
}

std::string RecommendedSummary::body_text() const {
  if (fits_.fitted == 0) return {};
  const double residual_rms_m =
      std::sqrt(fits_.residual_square_sum_m2 / static_cast<double>(fits_.fitted));
  std::string text;
  add_line(
      text, "body",
      fmt::format("residual of its fit {:.2g} mm rms; {} samples beyond {:.2g} mm not taken; "
                  "{} held back while its shape was learned",
                  residual_rms_m * 1e3, fits_.not_rigid, fits_.tolerance_m * 1e3, fits_.unsettled));
  return text;
}

std::string RecommendedSummary::nothing_text() const {
  std::string reasons;
  const auto add = [&reasons](std::uint64_t count, const std::string& words) {
    if (count == 0) return;
    reasons += fmt::format("{}{} samples {}", reasons.empty() ? "" : ", ", count, words);
  };
  add(fits_.degenerate, "had three points that coincide or lie on a line");
  add(fits_.not_rigid, "had points that did not keep their distances");
  add(fits_.unsettled, fmt::format("were held back to learn the body's shape, which takes {}",
                                   BodyShape<double>::kSamples));
  return reasons.empty() ? no_position_text() : "none: the jaw's pose is not known: " + reasons;
}

std::string RecommendedSummary::consistency_text() const {
  if (!has_enough()) return too_few_text();
  std::string text;
  add_line(text, "innovation", fmt::format("{:.4g} mm rms", innovation_rms_m() * 1e3));
  add_line(text, "mean NIS", per_axis("{:.3g}", [](const RecommendedSummary& s, int axis) {
                               return s.watches_[axis].monitor().mean_nis();
                             }) + " of the samples not rejected (1 if the noise is as stated)");
  // A monitor that had nothing to compare says 0.
  const InnovationMonitor<double>& followed = watches_[followed_index()].monitor();
  add_line(text, "whiteness",
           followed.innovation_correlation() == 0
               ? "not computed: no two innovations in a row"
               : per_axis("{:.2f}", [](const RecommendedSummary& s, int axis) {
                   return s.watches_[axis].monitor().innovation_correlation();
                 }) + " correlation of neighbouring innovations (0 if the model holds)");
  add_line(text, "noise floor",
           followed.noise_correlation() == 0
               ? "not computed: no eight positions in a row at even steps, or nothing varies"
               : per_axis("{:.2f}",
                          [](const RecommendedSummary& s, int axis) {
                            return s.watches_[axis].monitor().noise_correlation();
                          }) +
                     " correlation of neighbouring sixth differences (-0.86 if the noise is "
                     "white)" +
                     filtered_text());
  const std::string steps = rounding_steps_text();
  if (!steps.empty()) {
    add_line(text, "rounding", steps + " mm, most of the noise: smoothing would not show");
  }
  text += distrust_text(followed.mean_nis());
  add_line(text, "noise model",
           fmt::format("white; slow noise of the instrument, such as vibration, looks like motion: "
                       "as few as {} % of 95 % intervals of the position may then hold",
                       NoiseWatch::kWorstSlow_percent));
  return text;
}

std::string RecommendedSummary::rounding_steps_text() const {
  std::string text;
  for (int axis = 0; axis < axis_count(); ++axis) {
    if (!watches_[axis].hides_smoothing()) continue;
    if (!text.empty()) text += ", ";
    if (axis_count() == 3) text += fmt::format("{} ", "xyz"[axis]);
    text += fmt::format("{:.3g}", watches_[axis].rounding_step_m() * 1e3);
  }
  return text;
}

std::string RecommendedSummary::text() const {
  std::string text = times_text("");
  const bool adaptive = parameters_.noise.adaptation == Adaptation::on;
  add_line(text, "estimator",
           fmt::format("recommended: white-jerk motion, {}, assumed mass {:.4g} kg",
                       adaptive ? fmt::format("noise and jerk learned over {:.4g} s",
                                              parameters_.noise.memory_s)
                                : "noise and jerk as given",
                       parameters_.assumed_mass_kg));
  add_line(text, "delay",
           lag_ == 0 ? "none: each estimate uses the samples up to its own"
                     : fmt::format("{} samples, {:.4g} ms on average: each estimate uses that many "
                                   "later samples",
                                   lag_, lag_ * mean_step_s() * 1e3));
  text += body_text();
  if (last_.position_m.provenance == Provenance::not_computed) {
    add_line(text, "estimates", nothing_text());
    return text;
  }
  const std::string learned = has_enough() ? "estimated" : "from a first guess and too few samples";
  add_line(text, "noise", per_axis("{:.3g}", [](const RecommendedSummary& s, int axis) {
                            return s.last_.axes[axis].noise_sd_m * 1e3;
                          }) + (adaptive ? " mm sd at the end, " + learned : " mm sd, given"));
  add_line(text, "jerk", per_axis("{:.3g}", [](const RecommendedSummary& s, int axis) {
                           return s.last_.axes[axis].jerk_density_m2_s5;
                         }) + (adaptive ? " m^2/s^5 at the end, " + learned : " m^2/s^5, given"));
  text += consistency_text();
  const NoiseWatch& followed = watches_[followed_index()];
  const bool is_wrong = !is_trusted(followed.monitor().mean_nis()) || followed.is_correlated() ||
                        followed.is_filtered();
  text += last_values_text(is_wrong                     ? kDistrusted
                           : followed.hides_smoothing() ? "95 % unless smoothed before"
                                                        : kTrusted);
  if (last_.has_joint) return text + joint_text();
  text +=
      "Friction and mass are not computed: position alone does not determine them. What the "
      "published cascade shows for\nthem (--estimator published) is decided by its tuning.\n";
  return text;
}

std::string RecommendedSummary::joint_text() const {
  const JointEstimate<double> joint = conclusion();
  const auto words = [](const IdentifiedValue<double>& value, const char* unit) {
    const std::string shown = value.limit == JointLimit::none
                                  ? with_interval(value.quantity, 1, unit, "95 %")
                                  : fmt::format("{:.4g} {}, assumed", value.quantity.value, unit);
    return shown + limit_words(value);
  };
  std::string text;
  add_line(text, "  friction", words(joint.friction_Ns_m, "Ns/m"));
  add_line(text, "  mass", words(joint.mass_kg, "kg"));
  add_line(text, "  stiffness", words(joint.stiffness_N_m, "N/m"));
  add_line(text, "  offset", words(joint.offset_N, "N"));
  if (parameters_.joint.coulomb_N.sd > 0) {
    add_line(text, "  Coulomb", words(joint.coulomb_N, "N"));
  }
  if (parameters_.joint.delay == DelayModel::fitted) {
    add_line(text, "  delay", words(joint.delay_s, "s"));
  }
  if (std::isfinite(joint.residual_ratio)) {
    add_line(text, "drive model",
             fmt::format("residual {:.2f} of what noise makes (1 if drive and model explain the "
                         "motion), over {:.1f} s; noise of the drive {:.2g} N, of the positions "
                         "{:.2g} mm, by their own differences",
                         joint.residual_ratio, joint.used_s, joint.drive_noise_sd_N,
                         joint.position_noise_sd_m * 1e3));
  }
  const DriveParameters& drive = parameters_.joint.drive;
  if (joint.mass_kg.limit == JointLimit::implausible_mass) {
    add_line(text, "drive unit", unit_words(joint.mass_kg.fitted, parameters_.joint));
  } else if (!is_usual(joint.mass_kg)) {
    add_line(text, "drive unit",
             fmt::format("few jaws have such a mass ({:g} to {:g} kg): check the units of drive_N "
                         "and of the positions",
                         kUsualLeast_kg, kUsualMost_kg));
  }
  const std::string noise = drive_noise_words(joint.drive_noise_sd_N, drive.noise_sd_N);
  if (!noise.empty()) add_line(text, "drive noise", noise);
  add_line(text, "rests on",
           fmt::format("what was stated: drive in N, gain within {:g} %, axis within {:g} degrees; "
                       "positions to scale within {:g} %; delay {:g} +- {:g} ms; {:g} % of the "
                       "force missing. Twice the drive, or half the positions, makes friction and "
                       "mass twice as large",
                       drive.gain_sd * 100, drive.axis_angle_sd_rad * 180 / std::numbers::pi,
                       drive.position_scale_sd * 100, drive.delay_s * 1e3, drive.delay_sd_s * 1e3,
                       drive.missing_share * 100));
  return text +
         "Friction is the effective damping along the followed axis, of joint, muscle and tissue "
         "together.\n";
}

std::string RecommendedSummary::axes_where(bool (NoiseWatch::*is)() const) const {
  std::string axes;
  for (int axis = 0; axis < axis_count(); ++axis) {
    if (!(watches_[axis].*is)()) continue;
    if (!axes.empty()) axes += ", ";
    axes += axis_count() == 3 ? std::string(1, "xyz"[axis]) : "the axis";
  }
  return axes;
}

// Where the noise shows most that it is not white, unless it is between neighbours.
std::string RecommendedSummary::filtered_text() const {
  std::string text;
  for (int axis = 0; axis < axis_count(); ++axis) {
    const int lag = watches_[axis].monitor().filtered_lag();
    if (lag <= 1) continue;
    text += fmt::format("; {}{:.2f} {} samples apart ({:.2f})",
                        axis_count() == 3 ? fmt::format("{} ", "xyz"[axis]) : "",
                        watches_[axis].monitor().noise_correlation(lag), lag,
                        NoiseColour<double>::white(lag));
  }
  return text;
}

std::vector<std::string> RecommendedSummary::warnings() const {
  std::vector<std::string> warnings = ReplaySummary::warnings();
  const std::string filtered = axes_where(&NoiseWatch::is_filtered);
  const std::string correlated = axes_where(&NoiseWatch::is_correlated);
  std::string words;
  if (!filtered.empty()) {
    words += fmt::format(
        "the noise of the positions ({}) is not white: {}", filtered,
        has_uneven_frames() ? "frames were dropped or held, or they were smoothed"
                            : "they were smoothed or otherwise filtered before they were recorded");
  }
  if (!correlated.empty()) {
    words += fmt::format("{}neighbouring innovations ({}) are correlated, as {} make them",
                         filtered.empty() ? "" : "; ", correlated,
                         has_uneven_frames() ? "uneven frames" : "smoothed positions");
  }
  if (!words.empty()) {
    warnings.push_back(
        words + "; the filter takes noise for white, so its intervals are not to be relied on");
  }
  const std::string steps = has_enough() ? rounding_steps_text() : "";
  if (!steps.empty()) {
    warnings.push_back(
        fmt::format("the positions are rounded ({} mm), which hides their noise: if they were also "
                    "smoothed, a 95 % interval of the position may hold the truth in as few as {} "
                    "% of the samples",
                    steps, NoiseWatch::kWorstSmoothed_percent));
  }
  return warnings;
}

}  // namespace condyle::host
