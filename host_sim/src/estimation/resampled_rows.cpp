// SPDX-License-Identifier: Apache-2.0
#include "estimation/resampled_rows.h"

#include <algorithm>
#include <cmath>

namespace condyle::host {
namespace {

// A step between two samples, and where in it an instant lies.
struct Place {
  double step_s, share;

  // Variance of n-fold integrated white noise of density 1 between its ends.
  double bridge(int n) const {
    const int power = 2 * n - 1;
    const double factorial = n == 3 ? 2 : 1;
    return std::pow(step_s * share * (1 - share), power) / (power * factorial * factorial);
  }
};

Quantity<double> between(const Quantity<double>& a, const Quantity<double>& b, double value,
                         double bridge_variance) {
  Quantity<double> result;
  result.provenance = std::min({a.provenance, b.provenance, Provenance::derived});
  if (result.provenance == Provenance::not_computed) return {};
  result.value = value;
  result.standard_deviation =
      std::hypot(std::max(a.standard_deviation, b.standard_deviation), std::sqrt(bridge_variance));
  return result;
}

double linear(double from, double to, double share) {
  return from + share * (to - from);
}

// Hermite polynomial through values and slopes (per step).
double cubic(double p0, double v0, double p1, double v1, double u) {
  const double u2 = u * u, u3 = u2 * u, rise = 3 * u2 - 2 * u3;
  return p0 + rise * (p1 - p0) + (u3 - 2 * u2 + u) * v0 + (u3 - u2) * v1;
}

// The same through values, slopes and curvatures (per step).
double quintic(double p0, double v0, double a0, double p1, double v1, double a1, double u) {
  const double u2 = u * u, u3 = u2 * u, u4 = u3 * u, u5 = u4 * u;
  const double rise = 10 * u3 - 15 * u4 + 6 * u5;
  return p0 + rise * (p1 - p0) + (u - 6 * u3 + 8 * u4 - 3 * u5) * v0 +
         (-4 * u3 + 7 * u4 - 3 * u5) * v1 + (u2 - 3 * u3 + 3 * u4 - u5) / 2 * a0 +
         (u3 - 2 * u4 + u5) / 2 * a1;
}

AxisEstimate<double> between(const AxisEstimate<double>& a, const AxisEstimate<double>& b,
                             const Place& place) {
  AxisEstimate<double> axis;
  const double h = place.step_s, u = place.share;
  axis.noise_sd_m = a.noise_sd_m;
  axis.jerk_density_m2_s5 = a.jerk_density_m2_s5;
  axis.velocity_learned = linear(a.velocity_learned, b.velocity_learned, u);
  axis.acceleration_learned = linear(a.acceleration_learned, b.acceleration_learned, u);
  const double larger = std::fmax(a.jerk_density_m2_s5, b.jerk_density_m2_s5);
  const double density = std::isfinite(larger) ? larger : 0;
  const auto variance = [&](int n) { return density * place.bridge(n); };
  axis.position_m = between(
      a.position_m, b.position_m,
      quintic(a.position_m.value, h * a.velocity_m_s.value, h * h * a.acceleration_m_s2.value,
              b.position_m.value, h * b.velocity_m_s.value, h * h * b.acceleration_m_s2.value, u),
      variance(3));
  axis.velocity_m_s = between(a.velocity_m_s, b.velocity_m_s,
                              cubic(a.velocity_m_s.value, h * a.acceleration_m_s2.value,
                                    b.velocity_m_s.value, h * b.acceleration_m_s2.value, u),
                              variance(2));
  axis.acceleration_m_s2 =
      between(a.acceleration_m_s2, b.acceleration_m_s2,
              linear(a.acceleration_m_s2.value, b.acceleration_m_s2.value, u), variance(1));
  const double mass_kg = a.force_N.standard_deviation / a.acceleration_m_s2.standard_deviation;
  axis.force_N = between(a.force_N, b.force_N, linear(a.force_N.value, b.force_N.value, u),
                         std::isfinite(mass_kg) ? mass_kg * mass_kg * variance(1) : 0);
  return axis;
}

EstimateRow between(const EstimateRow& a, const EstimateRow& b, const Place& place) {
  EstimateRow row;
  row.axis_count = a.axis_count;
  row.point_axes = a.point_axes;
  for (int i = 0; i < a.axis_count; ++i) row.axes[i] = between(a.axes[i], b.axes[i], place);
  row.followed = between(a.followed, b.followed, place);
  row.position_m = row.followed.position_m;
  row.velocity_m_s = row.followed.velocity_m_s;
  row.force_N = row.followed.force_N;
  row.has_impedance = a.has_impedance;
  row.impedance = a.impedance;
  row.friction_Ns_m = a.friction_Ns_m;
  row.mass_kg = a.mass_kg;
  return row;
}

}  // namespace

void ResampledRows::give(EstimateRow row, const Take& take) {
  row.time_ns =
      start_ns_ + static_cast<TimeNs>(std::llround(static_cast<double>(next_) * 1e9 / rate_Hz_));
  row.events = events_;
  events_ = {};
  ++next_;
  take(row);
}

void ResampledRows::add(const EstimateRow& row, const Take& take) {
  events_.add(row.events);
  // The estimator does not take such samples.
  if (!row.time_ns || row.events.has(Event::time_reversed) ||
      row.events.has(Event::time_repeated)) {
    return;
  }
  const TimeNs now = *row.time_ns;
  if (!previous_ || row.events.has(Event::time_restarted) || now <= *previous_->time_ns) {
    start_ns_ = now;
    next_ = 0;
    give(row, take);
    previous_ = row;
    return;
  }
  const bool is_broken = row.events.has(Event::time_gap) || row.events.has(Event::state_restarted);
  const TimeNs before = *previous_->time_ns;
  const auto instant = [this](std::int64_t k) {
    return start_ns_ + static_cast<TimeNs>(std::llround(static_cast<double>(k) * 1e9 / rate_Hz_));
  };
  if (is_broken) {
    // The first instant that is not before this sample.
    next_ = std::max(
        next_,
        static_cast<std::int64_t>(static_cast<double>(now - start_ns_) * 1e-9 * rate_Hz_) - 1);
    while (instant(next_) < now) ++next_;
  }
  for (; instant(next_) < now;) {
    const double step_s = seconds(now - before);
    give(between(*previous_, row, {step_s, seconds(instant(next_) - before) / step_s}), take);
  }
  if (instant(next_) == now) give(row, take);
  previous_ = row;
}

}  // namespace condyle::host
