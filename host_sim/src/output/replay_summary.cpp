// SPDX-License-Identifier: Apache-2.0
#include "output/replay_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/number_text.h"
#include "output/event_text.h"

namespace condyle::host {
namespace {

constexpr double kUnevenShare = 0.01;
// Values below this fraction of their interval are shown as 0.
constexpr double kNothing = 1e-4;
constexpr std::uint64_t kFewestPositions = 3;
// Mean NIS beyond which the summary warns: the intervals are then wrong by 22 % or more.
constexpr double kTrustedNis = 1.5;
// Ratio of ranges from which the summary suggests another axis.
constexpr double kFarther = 2, kLeastMotion_m = 1e-3;
// Upper limit: a jaw in a freely moving head. Lower limit: the noise of the best tracker.
constexpr double kWidest_m = 0.5, kNarrowest_m = 3e-5;
constexpr double kShortestStep_s = 1.0 / 5000;

// No interval: the filter's own depends only on its tuning.
std::string without_interval(const Quantity<double>& quantity, const char* unit) {
  if (quantity.provenance == Provenance::not_computed) return "none";
  return fmt::format("{:.4g} {}, {}", quantity.value, unit, provenance_name(quantity.provenance));
}

// Why a force is derived; `acceleration`: provenance of its acceleration.
const char* force_text(Provenance force, Provenance acceleration) {
  if (force != Provenance::derived) return "";
  return acceleration == Provenance::derived
             ? ": assumed mass times an acceleration that the motion model predicted"
             : ": assumed mass times measured acceleration";
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
  point_axes_ = row.point_axes;
  std::array<double, 3> point_m{};
  std::copy_n(row.point_m.begin(), row.point_axes, point_m.begin());
  const bool is_measured = row.time_ns && std::all_of(point_m.begin(), point_m.end(),
                                                      [](double m) { return std::isfinite(m); });
  if (is_measured) {
    if (positions_++ == 0) first_m_ = point_m;
    has_moved_ = has_moved_ || point_m != first_m_;
    ranges_.add(point_m);
    step_watch_.add(*row.time_ns, point_m);
  } else if (!is_duplicate(row)) {
    step_watch_.add_missing();
  }
  if (row.position_m.provenance != Provenance::not_computed) last_ = row;
}

std::string ReplaySummary::with_interval(const Quantity<double>& quantity, double shown_per_si,
                                         const char* unit, const char* level) {
  if (quantity.provenance == Provenance::not_computed) return "none";
  const double half_width = kNormalQuantile95 * quantity.standard_deviation;
  const bool is_nothing = std::abs(quantity.value) < kNothing * half_width;
  return fmt::format("{:.4g} +- {:.2g} {} ({}), {}",
                     is_nothing ? 0.0 : quantity.value * shown_per_si, half_width * shown_per_si,
                     unit, level, provenance_name(quantity.provenance));
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
  return text + motion_text();
}

std::string ReplaySummary::motion_text() const {
  std::string text;
  const auto ranges_m = ranges_.ranges_m();
  if (point_axes_ == 1) {
    add_line(text, "range",
             fmt::format("{:.4g} mm, the middle 95 % of the positions", ranges_m[0] * 1e3));
  } else {
    add_line(text, "ranges",
             fmt::format("x {:.4g}, y {:.4g}, z {:.4g} mm, the middle 95 % of the positions",
                         ranges_m[0] * 1e3, ranges_m[1] * 1e3, ranges_m[2] * 1e3));
  }
  if (step_watch_.has_dropped()) {
    add_line(text, "frames",
             fmt::format("{} steps among even ones are two frames long: frames were dropped under "
                         "even time stamps",
                         step_watch_.dropped()));
  }
  if (step_watch_.has_held()) {
    add_line(text, "frames",
             fmt::format("{} positions during motion repeat the position before: frames were held "
                         "under even time stamps",
                         step_watch_.held()));
  }
  return text;
}

std::string ReplaySummary::unusable() const {
  const std::uint64_t repeated = events_[Event::time_repeated];
  if (2 * repeated > samples_) {
    return fmt::format(
        "{} of {} samples have the time of the sample before; write each sample's own time, with "
        "enough decimals",
        repeated, samples_);
  }
  if (positions_ == 0) return {};  // another message gives the reason
  if (positions_ < kFewestPositions) {
    return fmt::format(
        "{} of its samples {} a position, and a velocity takes {} at least; give a longer "
        "recording",
        positions_, positions_ == 1 ? "has" : "have", kFewestPositions);
  }
  if (!has_moved_) {
    return fmt::format(
        "all {} positions are the same, which a real instrument does not measure; check the "
        "recording",
        positions_);
  }
  return {};
}

std::string ReplaySummary::unusable_text() const {
  std::string text;
  add_line(text, "unusable", unusable());
  return text;
}

std::string ReplaySummary::no_position_text() const {
  const std::uint64_t far = events_[Event::position_out_of_range];
  return far == 0 ? "none: no sample had a position"
                  : fmt::format(
                        "none: no sample had a position; {} were beyond 10 m: check their "
                        "unit",
                        far);
}

std::vector<std::string> ReplaySummary::warnings() const {
  std::vector<std::string> warnings = unit_warnings();
  if (point_axes_ != 3) return warnings;
  const auto ranges_m = ranges_.ranges_m();
  const auto followed = static_cast<std::size_t>(followed_);
  const std::size_t other = livelier_axis(ranges_m, followed, kFarther, kLeastMotion_m);
  if (other == followed) return warnings;
  warnings.push_back(
      fmt::format("the motion is along {0} ({1:.4g} mm) more than along the followed {2} ({3:.4g} "
                  "mm); --axis {0} follows it",
                  "xyz"[other], ranges_m[other] * 1e3, "xyz"[followed], ranges_m[followed] * 1e3));
  return warnings;
}

std::vector<std::string> ReplaySummary::unit_warnings() const {
  std::vector<std::string> warnings;
  const auto ranges_m = ranges_.ranges_m();
  const double widest_m = *std::max_element(ranges_m.begin(), ranges_m.end());
  if (widest_m > kWidest_m || (widest_m > 0 && widest_m < kNarrowest_m)) {
    warnings.push_back(
        fmt::format("the positions span {:.2g} mm, but a jaw moves 1 to 70 mm: check their unit; "
                    "--unit mm or --unit m decides",
                    widest_m * 1e3));
  }
  if (steps_ > 0 && mean_step_s() < kShortestStep_s) {
    warnings.push_back(fmt::format(
        "{:.3g} samples per second, but a facebow gives 50 to 500: check the unit of the times",
        1 / mean_step_s()));
  }
  return warnings;
}

std::string ReplaySummary::last_values_text(const char* level) const {
  std::string text = "last values";
  if (last_.time_ns) {
    text += ", at ";
    append_time_s(text, *last_.time_ns);
    text += " s";
  }
  text += '\n';
  if (!has_enough()) level = "95 % by the filter's model, unchecked";
  add_line(text, "  position", with_interval(last_.position_m, 1e3, "mm", level));
  add_line(text, "  velocity", with_interval(last_.velocity_m_s, 1e3, "mm/s", level));
  add_line(text, "  force",
           with_interval(last_.force_N, 1, "N", level) +
               force_text(last_.force_N.provenance, last_.followed.acceleration_m_s2.provenance));
  return text;
}

std::string ReplaySummary::too_few_text() const {
  std::string text;
  add_line(text, "consistency",
           fmt::format("not judged: too few samples, {} innovations of the {} required", judged_,
                       kFewestInnovations));
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
             fmt::format("too {} by a factor of about {:.2g}: noise or model do not fit this "
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
  if (!unusable().empty()) return text + unusable_text();
  add_line(
      text, "estimator",
      fmt::format(
          "published cascade, stage 1 {} Euler, sample time {:.6g} s, assumed mass {:.4g} kg",
          parameters_.motion.discretisation == Discretisation::forward ? "forward" : "backward",
          parameters_.sample_time_s, parameters_.assumed_mass_kg));
  if (has_enough()) {
    add_line(text, "innovation", fmt::format("{:.4g} mm rms", innovation_rms_m() * 1e3));
    add_line(text, "mean NIS",
             fmt::format("motion {:.3g} (1 if noise and model are right); friction {:.3g}, mass "
                         "{:.3g} (not 2: stage 1's velocity is not an independent measurement)",
                         motion_nis_.value(), friction_nis_.value(), mass_nis_.value()));
    text += distrust_text(motion_nis_.value());
  } else {
    text += too_few_text();
  }
  if (last_.position_m.provenance == Provenance::not_computed) {
    add_line(text, "estimates", no_position_text());
    return text;
  }
  add_line(text, "verdict",
           fmt::format(
               "{}: {}. It judges the tuning, not the subject", verdict_name(last_.verdict),
               last_.verdict == Verdict::diverged
                   ? "the mass was not positive, or not a number, at some sample"
                   : fmt::format("the mass {} within 2 % of the assumed mass throughout "
                                 "the last quarter",
                                 last_.verdict == Verdict::matched ? "stayed" : "did not stay")));
  text += last_values_text(is_trusted(motion_nis_.value()) ? kTrusted : kDistrusted);
  add_line(text, "  friction", without_interval(last_.friction_Ns_m, "Ns/m"));
  add_line(text, "  mass", without_interval(last_.mass_kg, "kg"));
  text +=
      "Friction and mass are assumed, not measured: the force that drives their stages is the "
      "assumed mass times the\nacceleration seen in the same positions, so friction zero and the "
      "assumed mass fit every motion, and prior and\ntuning determine the values shown.\n";
  return text;
}

std::vector<std::string> PublishedSummary::warnings() const {
  std::vector<std::string> warnings = ReplaySummary::warnings();
  if (uneven_steps_ == 0) return warnings;
  warnings.push_back(fmt::format(
      "{} of {} steps ({:.4g} to {:.4g} ms) differ from the sample time {:.6g} s by more than 1 %; "
      "the published cascade treats every step as that long, without resampling",
      uneven_steps_, steps_, seconds(shortest_step_ns_) * 1e3, seconds(longest_step_ns_) * 1e3,
      parameters_.sample_time_s));
  return warnings;
}

}  // namespace condyle::host
