// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "output/impedance_text.h"
#include "output/replay_summary.h"

namespace condyle::host {
void RecommendedSummary::add(const EstimateRow& row) {
  ReplaySummary::add(row);
  const double step_s =
      last_step_ns_ ? seconds(*last_step_ns_) : std::numeric_limits<double>::quiet_NaN();
  if (is_duplicate(row)) return;
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
      fmt::format("residual of its fit {:.2g} mm rms; {} samples beyond {:.2g} mm not used; {} "
                  "withheld while its shape was learned",
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
  add(fits_.not_rigid, "had points whose distances changed");
  add(fits_.unsettled, fmt::format("were withheld to learn the body's shape, which takes {}",
                                   BodyShape<double>::kSamples));
  return reasons.empty() ? no_position_text() : "none: the jaw's pose is not known: " + reasons;
}

std::string RecommendedSummary::consistency_text() const {
  if (!has_enough()) return too_few_text();
  std::string text;
  add_line(text, "innovation", fmt::format("{:.4g} mm rms", innovation_rms_m() * 1e3));
  add_line(text, "mean NIS", per_axis("{:.3g}", [](const RecommendedSummary& s, int axis) {
                               return s.watches_[axis].monitor().mean_nis();
                             }) + " of the samples not rejected (1 if noise and model are right)");
  // A monitor without pairs returns 0.
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
    add_line(text, "rounding", steps + " mm, most of the noise: smoothing would not be detected");
  }
  text += distrust_text(followed.mean_nis());
  add_line(
      text, "noise model",
      fmt::format("white; slow noise of the instrument, such as vibration, looks like motion: as "
                  "few as {} % of 95 % intervals of the position may then contain the truth",
                  NoiseWatch::kWorstSlow_percent));
  return text;
}

std::string RecommendedSummary::learning_text() const {
  if (!learning_) return {};
  std::string corrected, gained, silent;
  bool is_corrected = false;
  for (int axis = 0; axis < axis_count(); ++axis) {
    const LearningCounts counts = learning_(axis);
    const std::string name = axis_count() == 3 ? std::string{"xyz"[axis], ' '} : "";
    const char* const comma = axis > 0 ? ", " : "";
    const auto samples = static_cast<double>(std::max<std::uint64_t>(counts.samples, 1));
    is_corrected = is_corrected || counts.corrected > 0;
    corrected += fmt::format("{}{}{:.0f}", comma, name,
                             100 * static_cast<double>(counts.corrected) / samples);
    gained += counts.compared < kFewestInnovations
                  ? fmt::format("{}{}not known", comma, name)
                  : fmt::format("{}{}{:.2f}", comma, name, counts.error_ratio());
    if (2 * counts.silent_for_noise > counts.samples) {
      silent += fmt::format("{}{}", silent.empty() ? "" : ", ", name.empty() ? "the axis" : name);
    }
  }
  std::string words =
      fmt::format("velocity corrected by learning in {} % of the samples", corrected);
  if (lag_ == 0) {
    words += fmt::format("; error of the next position there, divided by the filter's: {}", gained);
  } else if (!is_corrected) {
    words = "nothing: the lag is not below the 50 ms after which learning corrects";
  }
  if (!silent.empty()) words += "; noise not white, so nothing is corrected: " + silent;
  std::string text;
  add_line(text, "learned", words);
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
  if (!unusable().empty()) return text + unusable_text();
  const bool adaptive = parameters_.noise.adaptation == Adaptation::on;
  add_line(text, "estimator",
           fmt::format("recommended: white-jerk motion, {}, assumed mass {:.4g} kg",
                       adaptive ? fmt::format("noise and jerk learned over {:.4g} s",
                                              parameters_.noise.memory_s)
                                : "noise and jerk as given",
                       parameters_.assumed_mass_kg));
  add_line(text, "lag",
           lag_ == 0 ? "none: each estimate uses the samples up to its own"
                     : fmt::format("{} samples, {:.4g} ms on average: each estimate uses that many "
                                   "later samples, the last ones only those that follow",
                                   lag_, lag_ * mean_step_s() * 1e3));
  text += body_text();
  if (last_.position_m.provenance == Provenance::not_computed) {
    add_line(text, "estimates", nothing_text());
    return text;
  }
  const std::string learned =
      has_enough() ? "estimated" : "from an initial guess and too few samples";
  add_line(text, "noise", per_axis("{:.3g}", [](const RecommendedSummary& s, int axis) {
                            return s.last_.axes[axis].noise_sd_m * 1e3;
                          }) + (adaptive ? " mm sd at the end, " + learned : " mm sd, given"));
  add_line(text, "jerk", per_axis("{:.3g}", [](const RecommendedSummary& s, int axis) {
                           return s.last_.axes[axis].jerk_density_m2_s5;
                         }) + (adaptive ? " m^2/s^5 at the end, " + learned : " m^2/s^5, given"));
  text += consistency_text();
  text += learning_text();
  const NoiseWatch& followed = watches_[followed_index()];
  const bool is_wrong = !is_trusted(followed.monitor().mean_nis()) || followed.is_correlated() ||
                        followed.is_filtered();
  text += last_values_text(is_wrong                     ? kDistrusted
                           : followed.hides_smoothing() ? "95 % unless smoothed before"
                                                        : kTrusted);
  if (last_.has_impedance) return text + impedance_text(conclusion(), parameters_.impedance);
  text +=
      "Friction and mass are not computed: position alone does not determine them. For the "
      "published cascade\n(--estimator published), the tuning determines them.\n";
  return text;
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

// The distance at which the noise deviates most from white, unless it is 1.
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
        has_uneven_frames()
            ? "frames were dropped or held, or the positions were smoothed"
            : "the positions were smoothed or otherwise filtered before they were recorded");
  }
  if (!correlated.empty()) {
    words += fmt::format("{}neighbouring innovations ({}) are correlated, probably because of {}",
                         filtered.empty() ? "" : "; ", correlated,
                         has_uneven_frames() ? "uneven frames" : "smoothed positions");
  }
  if (!words.empty()) {
    warnings.push_back(words +
                       "; the filter assumes white noise, so its intervals are not reliable");
  }
  const std::string steps = has_enough() ? rounding_steps_text() : "";
  if (!steps.empty()) {
    warnings.push_back(
        fmt::format("the positions are rounded ({} mm), which hides their noise: if they were also "
                    "smoothed, a 95 % interval of the position may contain the truth in as few as "
                    "{} % of the samples",
                    steps, NoiseWatch::kWorstSmoothed_percent));
  }
  return warnings;
}

}  // namespace condyle::host
