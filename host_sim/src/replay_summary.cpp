// SPDX-License-Identifier: Apache-2.0
#include "replay_summary.h"

#include <fmt/format.h>

#include <cmath>

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

}  // namespace

void ReplaySummary::add(const Sample& sample, const PublishedEstimate<double>& estimate) {
  ++samples_;
  if (sample.time_valid && !estimate.events.has(Event::time_reversed)) {
    if (previous_time_ns_ && !estimate.events.has(Event::time_restarted)) {
      const TimeNs step_ns = sample.time_ns - *previous_time_ns_;
      const double T = parameters_.sample_time_s;
      if (std::abs(seconds(step_ns) - T) > kUnevenShare * T) ++uneven_steps_;
      shortest_step_ns_ = steps_ == 0 ? step_ns : std::min(shortest_step_ns_, step_ns);
      longest_step_ns_ = std::max(longest_step_ns_, step_ns);
      duration_ns_ += step_ns;
      ++steps_;
    }
    previous_time_ns_ = sample.time_ns;
  }
  innovation_squared_.add(estimate.innovation_m * estimate.innovation_m);
  motion_nis_.add(estimate.motion_nis);
  friction_nis_.add(estimate.friction_nis);
  mass_nis_.add(estimate.mass_nis);
  events_.add(estimate.events);
  if (estimate.position_m.provenance == Provenance::not_computed) return;
  last_ = estimate;
  last_time_ns_.reset();
  if (sample.time_valid) last_time_ns_ = sample.time_ns;
}

std::string ReplaySummary::text() const {
  std::string text;
  const auto line = [&text](const char* label, const std::string& words) {
    text += fmt::format("{:<12}{}\n", label, words);
  };
  const double duration_s = seconds(duration_ns_);
  line("duration", fmt::format("{:.6g} s, {} samples", duration_s, samples_));
  if (duration_s > 0) {
    line("rate", fmt::format("{:.5g} Hz on average; steps {:.4g} to {:.4g} ms; {} of {} differ "
                             "from the sample time by more than 1 %",
                             static_cast<double>(steps_) / duration_s, shortest_step_s() * 1e3,
                             longest_step_s() * 1e3, uneven_steps_, steps_));
  }
  line("gaps", fmt::format("{}", events_[Event::time_gap]));
  std::string events;
  for (std::size_t i = 0; i < kEventCount; ++i) {
    const auto event = static_cast<Event>(i);
    if (events_[event] == 0) continue;
    events += fmt::format("{}{} {}", events.empty() ? "" : ", ", events_[event], event_name(event));
  }
  line("events", events.empty() ? "none" : events);
  line("estimator",
       fmt::format(
           "published cascade, stage 1 {} Euler, sample time {:.6g} s, assumed mass {:.4g} "
           "kg",
           parameters_.motion.discretisation == Discretisation::forward ? "forward" : "backward",
           parameters_.sample_time_s, parameters_.assumed_mass_kg));
  const auto mean = [](const Mean& m) { return m.sum / static_cast<double>(m.count); };
  if (innovation_squared_.count > 0) {
    line("innovation", fmt::format("{:.4g} mm rms", std::sqrt(mean(innovation_squared_)) * 1e3));
    line("mean NIS", fmt::format("motion {:.3g} (1 if the noise is as stated); friction {:.3g}, "
                                 "mass {:.3g} (not 2: stage 1's velocity is no independent "
                                 "measurement)",
                                 mean(motion_nis_), mean(friction_nis_), mean(mass_nis_)));
  }
  const double trust = motion_nis_.count > 0 ? mean(motion_nis_) : 0;
  const bool trusted = trust <= kTrustedNis && trust >= 1 / kTrustedNis;
  if (trust > 0 && !trusted) {
    const double factor = std::sqrt(trust);
    line("intervals",
         fmt::format("too {} by a factor of about {:.2g}: the stated noise does not fit this "
                     "recording",
                     factor > 1 ? "narrow" : "wide", factor > 1 ? factor : 1 / factor));
  }
  if (last_.position_m.provenance == Provenance::not_computed) {
    line("estimates", "none: no sample had a position");
    return text;
  }
  line("verdict",
       fmt::format(
           "{}: {}. It judges the tuning, not the subject", verdict_name(last_.verdict),
           last_.verdict == Verdict::diverged
               ? "the mass was not positive, or no number, at some sample"
               : fmt::format("the mass {} within 2 % of the assumed mass throughout the "
                             "last quarter",
                             last_.verdict == Verdict::matched ? "stayed" : "did not stay")));
  text += last_time_ns_ ? fmt::format("last values, at {:.6g} s\n", seconds(*last_time_ns_))
                        : std::string("last values\n");
  const char* const level = trusted ? "95 %" : "95 % if the intervals were right";
  line("  position", with_interval(last_.position_m, 1e3, "mm", level));
  line("  velocity", with_interval(last_.velocity_m_s, 1e3, "mm/s", level));
  line("  force", with_interval(last_.force_N, 1, "N", level) +
                      (last_.force_N.provenance == Provenance::derived
                           ? ": assumed mass times measured acceleration"
                           : ""));
  line("  friction", without_interval(last_.friction_Ns_m, "Ns/m"));
  line("  mass", without_interval(last_.mass_kg, "kg"));
  text +=
      "Friction and mass are assumed, not measured: the force that drives their stages is the "
      "assumed mass times the\nacceleration seen in the same positions, so friction zero and the "
      "assumed mass fit every motion, and prior and\ntuning decide what is shown.\n";
  return text;
}

}  // namespace condyle::host
