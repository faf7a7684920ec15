// SPDX-License-Identifier: Apache-2.0
#include "hosted/estimates/followed_cycles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace condyle::host {
namespace {

constexpr TimeNs kNewSequence_ns = 2'000'000'000;

bool is_known(const Quantity<double>& quantity) {
  return quantity.provenance == Provenance::measured || quantity.provenance == Provenance::derived;
}

}  // namespace

std::optional<FoundCycle> FollowedCycles::add(const RecommendedEstimate<double>& estimate) {
  if (!estimate.is_ready || !estimate.time_valid) return std::nullopt;
  if (estimate.events.has(Event::time_restarted)) restart();
  const AxisEstimate<double>& axis =
      estimate.axes[estimate.axis_count == 3 ? static_cast<int>(choice_.followed) : 0];
  const bool is_taken =
      std::isfinite(axis.innovation_m) && !estimate.events.has(Event::outlier_rejected);
  if (!is_taken || !is_known(axis.position_m) || !is_known(axis.velocity_m_s)) return std::nullopt;
  const double sign = choice_.closes_upward ? 1 : -1;
  CycleSample<double> sample;
  sample.time_ns = estimate.time_ns;
  sample.height_m = sign * axis.position_m.value;
  sample.height_sd_m = axis.position_m.standard_deviation;
  sample.rate_m_s = sign * axis.velocity_m_s.value;
  sample.rate_sd_m_s = axis.velocity_m_s.standard_deviation;
  double square = 0, variance = 0;
  for (int i = 0; i < estimate.axis_count; ++i) {
    const Quantity<double>& velocity = estimate.axes[i].velocity_m_s;
    square += velocity.value * velocity.value;
    variance += std::pow(velocity.value * velocity.standard_deviation, 2);
  }
  sample.speed_m_s = std::sqrt(square);
  sample.speed_sd_m_s =
      square > 0 ? std::sqrt(variance / square) : axis.velocity_m_s.standard_deviation;
  MotionCycle<double> cycle;
  if (!cycles_.add(sample, cycle)) return std::nullopt;
  return place(cycle);
}

std::optional<FoundCycle> FollowedCycles::finish() {
  MotionCycle<double> cycle;
  if (!cycles_.finish(cycle)) return std::nullopt;
  return place(cycle);
}

FoundCycle FollowedCycles::place(const MotionCycle<double>& cycle) {
  FoundCycle found{cycle, 0, 0};
  const bool continues = last_end_ns_ && cycle.begin_ns >= *last_end_ns_ &&
                         cycle.begin_ns - *last_end_ns_ <= kNewSequence_ns;
  if (!continues) ++sequence_;
  found.sequence = sequence_;
  if (cycle.verdict == CycleVerdict::taken) found.number = ++taken_;
  last_end_ns_ = cycle.end_ns;
  return found;
}

std::string rejection_text(const MotionCycle<double>& cycle) {
  switch (cycle.verdict) {
    case CycleVerdict::gap:
      return fmt::format("a gap of {:.2f} s", seconds(cycle.longest_gap_ns));
    case CycleVerdict::too_short:
    case CycleVerdict::too_long:
      return fmt::format("it lasts {:.2f} s", seconds(cycle.end_ns - cycle.begin_ns));
    case CycleVerdict::taken:
      break;
  }
  return "";
}

}  // namespace condyle::host
