// SPDX-License-Identifier: Apache-2.0
#include "replay_summary.h"

#include <fmt/format.h>

#include <cmath>

#include "event_text.h"
#include "number_text.h"

namespace condyle::host {
namespace {

constexpr double kUnevenShare = 0.01;
// Mean NIS beyond which the intervals are said to be off: they are then wrong by 22 % and more.
constexpr double kTrustedNis = 1.5;

std::string with_interval(const Quantity<double>& quantity, double shown_per_si, const char* unit,
                          const char* level) {
  if (quantity.provenance == Provenance::not_computed) return "none";
  return fmt::format("{:.4g} +- {:.2g} {} ({}), {}", quantity.value * shown_per_si,
                     kNormalQuantile95 * quantity.standard_deviation * shown_per_si, unit, level,
                     provenance_name(quantity.provenance));
}

// No interval: the filter's own would be that of its tuning.
std::string without_interval(const Quantity<double>& quantity, const char* unit) {
  if (quantity.provenance == Provenance::not_computed) return "none";
  return fmt::format("{:.4g} {}, {}", quantity.value, unit, provenance_name(quantity.provenance));
}

// Why a force is derived; `acceleration` is where its acceleration comes from.
const char* force_words(Provenance force, Provenance acceleration) {
  if (force != Provenance::derived) return "";
  return acceleration == Provenance::derived
             ? ": assumed mass times an acceleration that the motion model carried over"
             : ": assumed mass times measured acceleration";
}

// Why a value is not measured.
const char* limit_words(JointLimit limit) {
  switch (limit) {
    case JointLimit::none:
      return "";
    case JointLimit::no_drive:
      return ": no drive was measured while the position was";
    case JointLimit::too_early:
      return ": too few positions to judge the model by";
    case JointLimit::model:
      return ": drive and model do not explain the motion; another force acts, or the noise is not "
             "as stated";
    case JointLimit::information:
      return ": the motion tells less of it than the prior does";
    case JointLimit::resolution:
      return ": the motion tells too little of it for the stated resolution; record longer";
    case JointLimit::friction_or_delay:
      return ": this motion cannot tell friction from a delay of the drive; measure the delay, or "
             "let "
             "the rhythm vary";
    case JointLimit::mass_or_stiffness:
      return ": this motion cannot tell mass from stiffness; let the rhythm vary";
    case JointLimit::viscous_or_coulomb:
      return ": this motion cannot tell viscous from Coulomb friction; let its speed vary";
    case JointLimit::gain:
      return ": the uncertainty of the drive's gain is too large for the stated resolution";
    case JointLimit::delay:
      return ": the uncertainty of the drive's delay, which acts like friction, is too large";
    case JointLimit::missing:
      return ": the drive may miss too much of the force (--drive-missing SHARE, if that is known)";
  }
  return "";
}

}  // namespace

void ReplaySummary::add(const EstimateRow& row) {
  ++samples_;
  last_step_ns_.reset();
  if (row.time_ns && !row.events.has(Event::time_reversed)) {
    if (previous_time_ns_ && !row.events.has(Event::time_restarted)) {
      const TimeNs step_ns = *row.time_ns - *previous_time_ns_;
      shortest_step_ns_ = steps_ == 0 ? step_ns : std::min(shortest_step_ns_, step_ns);
      longest_step_ns_ = std::max(longest_step_ns_, step_ns);
      duration_ns_ += step_ns;
      ++steps_;
      last_step_ns_ = step_ns;
    }
    previous_time_ns_ = row.time_ns;
  }
  if (std::isfinite(row.innovation_m)) {
    innovation_square_sum_m2_ += row.innovation_m * row.innovation_m;
    ++innovations_;
    judged_ += is_unexpected(row.events) ? 0U : 1U;
  }
  events_.add(row.events);
  if (row.position_m.provenance != Provenance::not_computed) last_ = row;
}

void ReplaySummary::add_line(std::string& text, const char* label, const std::string& words) {
  text += fmt::format("{:<12}{}\n", label, words);
}

double ReplaySummary::innovation_rms_m() const {
  return innovations_ > 0 ? std::sqrt(innovation_square_sum_m2_ / static_cast<double>(innovations_))
                          : std::numeric_limits<double>::quiet_NaN();
}

double ReplaySummary::mean_step_s() const {
  return steps_ > 0 ? seconds(duration_ns_) / static_cast<double>(steps_) : 0;
}

std::string ReplaySummary::times_text(const std::string& steps_note) const {
  std::string text;
  const double duration_s = seconds(duration_ns_);
  add_line(text, "duration", fmt::format("{:.6g} s, {} samples", duration_s, samples_));
  if (duration_s > 0) {
    add_line(
        text, "rate",
        fmt::format("{:.5g} Hz on average; steps {:.4g} to {:.4g} ms{}", 1 / mean_step_s(),
                    seconds(shortest_step_ns_) * 1e3, seconds(longest_step_ns_) * 1e3, steps_note));
  }
  add_line(text, "gaps", fmt::format("{}", events_[Event::time_gap]));
  add_line(text, "events", event_text(events_));
  return text;
}

std::string ReplaySummary::last_values_text(bool trusted) const {
  std::string text = "last values";
  if (last_.time_ns) {
    text += ", at ";
    append_time_s(text, *last_.time_ns);
    text += " s";
  }
  text += '\n';
  const char* const level = !has_enough() ? "95 % by the filter's model, unchecked"
                            : trusted     ? "95 %"
                                          : "95 % if the intervals were right";
  add_line(text, "  position", with_interval(last_.position_m, 1e3, "mm", level));
  add_line(text, "  velocity", with_interval(last_.velocity_m_s, 1e3, "mm/s", level));
  add_line(text, "  force",
           with_interval(last_.force_N, 1, "N", level) +
               force_words(last_.force_N.provenance, last_.followed.acceleration_m_s2.provenance));
  return text;
}

std::string ReplaySummary::too_few_text() const {
  std::string text;
  add_line(text, "consistency",
           fmt::format("not judged: too few samples, {} innovations of the {} that it takes",
                       judged_, kFewestInnovations));
  return text;
}

bool ReplaySummary::is_trusted(double mean_nis) {
  return mean_nis <= kTrustedNis && mean_nis >= 1 / kTrustedNis;
}

std::string ReplaySummary::distrust_text(double mean_nis) {
  std::string text;
  if (mean_nis > 0 && !is_trusted(mean_nis)) {
    const double factor = std::sqrt(mean_nis);
    add_line(text, "intervals",
             fmt::format("too {} by a factor of about {:.2g}: the stated noise does not fit this "
                         "recording",
                         factor > 1 ? "narrow" : "wide", factor > 1 ? factor : 1 / factor));
  }
  return text;
}

void PublishedSummary::add(const EstimateRow& row) {
  ReplaySummary::add(row);
  const double T = parameters_.sample_time_s;
  if (last_step_ns_ && std::abs(seconds(*last_step_ns_) - T) > kUnevenShare * T) ++uneven_steps_;
  motion_nis_.add(row.motion_nis);
  friction_nis_.add(row.friction_nis);
  mass_nis_.add(row.mass_nis);
}

std::string PublishedSummary::text() const {
  std::string text = times_text(fmt::format(
      "; {} of {} differ from the sample time by more than 1 %", uneven_steps_, steps_));
  add_line(
      text, "estimator",
      fmt::format(
          "published cascade, stage 1 {} Euler, sample time {:.6g} s, assumed mass {:.4g} kg",
          parameters_.motion.discretisation == Discretisation::forward ? "forward" : "backward",
          parameters_.sample_time_s, parameters_.assumed_mass_kg));
  if (has_enough()) {
    add_line(text, "innovation", fmt::format("{:.4g} mm rms", innovation_rms_m() * 1e3));
    add_line(text, "mean NIS",
             fmt::format("motion {:.3g} (1 if the noise is as stated); friction {:.3g}, mass "
                         "{:.3g} (not 2: stage 1's velocity is no independent measurement)",
                         motion_nis_.value(), friction_nis_.value(), mass_nis_.value()));
    text += distrust_text(motion_nis_.value());
  } else {
    text += too_few_text();
  }
  if (last_.position_m.provenance == Provenance::not_computed) {
    add_line(text, "estimates", "none: no sample had a position");
    return text;
  }
  add_line(text, "verdict",
           fmt::format(
               "{}: {}. It judges the tuning, not the subject", verdict_name(last_.verdict),
               last_.verdict == Verdict::diverged
                   ? "the mass was not positive, or no number, at some sample"
                   : fmt::format("the mass {} within 2 % of the assumed mass throughout "
                                 "the last quarter",
                                 last_.verdict == Verdict::matched ? "stayed" : "did not stay")));
  text += last_values_text(is_trusted(motion_nis_.value()));
  add_line(text, "  friction", without_interval(last_.friction_Ns_m, "Ns/m"));
  add_line(text, "  mass", without_interval(last_.mass_kg, "kg"));
  text +=
      "Friction and mass are assumed, not measured: the force that drives their stages is the "
      "assumed mass times the\nacceleration seen in the same positions, so friction zero and the "
      "assumed mass fit every motion, and prior and\ntuning decide what is shown.\n";
  return text;
}

std::string PublishedSummary::warning() const {
  if (uneven_steps_ == 0) return {};
  return fmt::format(
      "{} of {} steps ({:.4g} to {:.4g} ms) differ from the sample time {:.6g} s by more than 1 %; "
      "the published cascade takes every step as that long, and nothing is resampled",
      uneven_steps_, steps_, seconds(shortest_step_ns_) * 1e3, seconds(longest_step_ns_) * 1e3,
      parameters_.sample_time_s);
}

void RecommendedSummary::add(const EstimateRow& row) {
  ReplaySummary::add(row);
  const double step_s =
      last_step_ns_ ? seconds(*last_step_ns_) : std::numeric_limits<double>::quiet_NaN();
  if (is_told_twice(row)) return;
  const bool is_rejected = row.events.has(Event::outlier_rejected);
  for (int i = 0; i < row.axis_count; ++i) {
    monitors_[i].add(standardised_innovation(row, i),
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
  return reasons.empty() ? "none: no sample had a position"
                         : "none: the jaw's pose is not known: " + reasons;
}

std::string RecommendedSummary::consistency_text() const {
  if (!has_enough()) return too_few_text();
  std::string text;
  add_line(text, "innovation", fmt::format("{:.4g} mm rms", innovation_rms_m() * 1e3));
  add_line(text, "mean NIS", per_axis("{:.3g}", [](const RecommendedSummary& s, int axis) {
                               return s.monitors_[axis].mean_nis();
                             }) + " of the samples not rejected (1 if the noise is as stated)");
  // A monitor that had nothing to compare says 0.
  const InnovationMonitor<double>& followed = monitors_[followed_index()];
  add_line(text, "whiteness",
           followed.innovation_correlation() == 0
               ? "not computed: no two innovations in a row"
               : per_axis("{:.2f}", [](const RecommendedSummary& s, int axis) {
                   return s.monitors_[axis].innovation_correlation();
                 }) + " correlation of neighbouring innovations (0 if the model holds)");
  add_line(
      text, "noise floor",
      followed.noise_correlation() == 0
          ? "not computed: no eight positions in a row at even steps, or nothing varies"
          : per_axis("{:.2f}", [](const RecommendedSummary& s,
                                  int axis) { return s.monitors_[axis].noise_correlation(); }) +
                " correlation of neighbouring sixth differences (-0.86 if the noise is "
                "white)" +
                filtered_text());
  return text + distrust_text(followed.mean_nis());
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
  const InnovationMonitor<double>& followed = monitors_[followed_index()];
  text += last_values_text(is_trusted(followed.mean_nis()) && !followed.is_correlated() &&
                           !followed.is_filtered());
  if (last_.has_joint) return text + joint_text();
  text +=
      "Friction and mass are not computed: position alone does not determine them. What the "
      "published cascade shows for\nthem (--estimator published) is decided by its tuning.\n";
  return text;
}

std::string RecommendedSummary::joint_text() const {
  const JointEstimate<double>& joint = last_.joint;
  const auto words = [](const IdentifiedValue<double>& value, const char* unit) {
    const char* const reason = limit_words(value.limit);
    const std::string shown = value.limit == JointLimit::none
                                  ? with_interval(value.quantity, 1, unit, "95 %")
                                  : fmt::format("{:.4g} {}, assumed", value.quantity.value, unit);
    return fmt::format("{}{}; information share {:.2f}", shown, reason, value.information);
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
  add_line(
      text, "drive model",
      fmt::format("mean NIS {:.3g}, correlation of neighbouring innovations {:.2f} (1 and 0 if "
                  "drive and model explain the motion); observability {:.3f} (information share of "
                  "the least known combination)",
                  joint.mean_nis, joint.innovation_correlation, joint.observability));
  return text +
         "Friction is the effective damping along the followed axis, of joint, muscle and tissue "
         "together. It and the mass rest on\nwhat was stated of the drive: its noise, gain, delay "
         "and the share of the force it may miss.\n";
}

std::string RecommendedSummary::axes_where(bool (InnovationMonitor<double>::*is)() const) const {
  std::string axes;
  for (int axis = 0; axis < axis_count(); ++axis) {
    if (!(monitors_[axis].*is)()) continue;
    if (!axes.empty()) axes += ", ";
    axes += axis_count() == 3 ? std::string(1, "xyz"[axis]) : "the axis";
  }
  return axes;
}

// Where the noise shows most that it is not white, unless it is between neighbours.
std::string RecommendedSummary::filtered_text() const {
  std::string text;
  for (int axis = 0; axis < axis_count(); ++axis) {
    const int lag = monitors_[axis].filtered_lag();
    if (lag <= 1) continue;
    text +=
        fmt::format("; {}{:.2f} {} samples apart ({:.2f})",
                    axis_count() == 3 ? fmt::format("{} ", "xyz"[axis]) : "",
                    monitors_[axis].noise_correlation(lag), lag, NoiseColour<double>::white(lag));
  }
  return text;
}

std::string RecommendedSummary::warning() const {
  const std::string filtered = axes_where(&InnovationMonitor<double>::is_filtered);
  const std::string correlated = axes_where(&InnovationMonitor<double>::is_correlated);
  if (filtered.empty() && correlated.empty()) return {};
  std::string words;
  if (!filtered.empty()) {
    words += fmt::format(
        "the noise of the positions ({}) is not white: they were smoothed or otherwise filtered "
        "before they were recorded",
        filtered);
  }
  if (!correlated.empty()) {
    words += fmt::format(
        "{}neighbouring innovations ({}) are correlated, as smoothed positions "
        "make them",
        filtered.empty() ? "" : "; ", correlated);
  }
  return words + "; the filter takes noise for white, so its intervals are not to be relied on";
}

}  // namespace condyle::host
