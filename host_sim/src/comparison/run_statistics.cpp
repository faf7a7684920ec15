// SPDX-License-Identifier: Apache-2.0
#include "comparison/run_statistics.h"

#include <cmath>
#include <numbers>

namespace condyle::host {
namespace {

constexpr double kIntervalShare = 0.95;
constexpr double kGlitchShare = 0.001, kGlitchRange_mm = 100;

// The estimator had no usable position.
bool is_without_position(const EstimateRow& row) {
  for (const Event event :
       {Event::time_missing, Event::time_reversed, Event::position_missing, Event::zero_filled,
        Event::position_repeated, Event::position_frozen, Event::points_not_rigid}) {
    if (row.events.has(event)) return true;
  }
  return is_duplicate(row);
}

bool is_measured(const Quantity<double>& quantity) {
  return quantity.provenance == Provenance::measured;
}

}  // namespace

double RunStatistics::predicted_sd_m(const EstimateRow& row) const {
  if (row.axis_count == 0) return std::abs(row.innovation_m) / std::sqrt(row.motion_nis);
  return row.axes[axis_of(row)].innovation_sd_m;
}

bool RunStatistics::has_prediction(const EstimateRow& row) const {
  const double sd_m = predicted_sd_m(row);
  return std::isfinite(row.innovation_m) && std::isfinite(sd_m) && sd_m > 0;
}

double RunStatistics::score_of(const EstimateRow& row) const {
  const double sd_mm = 1e3 * predicted_sd_m(row), e = 1e3 * row.innovation_m / sd_mm;
  const double normal_per_mm = std::exp(-e * e / 2) / (sd_mm * std::sqrt(2 * std::numbers::pi));
  return std::log((1 - kGlitchShare) * normal_per_mm + kGlitchShare / kGlitchRange_mm);
}

void RunStatistics::add(const EstimateRow& row, const EstimateRow& first, double step_s,
                        bool is_compared) {
  ++samples_;
  const bool is_rejected = row.events.has(Event::outlier_rejected);
  missing_ += is_without_position(row) ? 1U : 0U;
  rejected_ += is_rejected ? 1U : 0U;
  if (is_compared) {
    error_square_m2_.add(row.innovation_m * row.innovation_m);
    error_m_.add(std::abs(row.innovation_m));
    const double score = score_of(row);
    score_.add(score);
    score_difference_.add(score - score_of(first));
  }
  if (!is_duplicate(row)) {
    const double standardised = standardised_innovation(row, axis_of(row));
    monitor_.add(standardised, is_rejected ? EstimateRow::kNone : row.measured_position_m, step_s);
    if (std::isfinite(standardised)) nis_.add(standardised * standardised);
    pairs_ += has_previous_ && std::isfinite(standardised) ? 1U : 0U;
    has_previous_ = std::isfinite(standardised);
  }
  add_motion(row, first);
  friction_Ns_m_ = row.friction_Ns_m;
  mass_kg_ = row.mass_kg;
}

void RunStatistics::add_motion(const EstimateRow& row, const EstimateRow& first) {
  if (is_measured(row.position_m)) position_m_.add(row.position_m.value);
  if (!is_measured(row.velocity_m_s)) return;
  const double velocity_m_s = row.velocity_m_s.value;
  velocity_square_.add(velocity_m_s * velocity_m_s);
  if (velocity_m_s > 0) up_m_s_.add(velocity_m_s);
  if (velocity_m_s < 0) down_m_s_.add(-velocity_m_s);
  if (is_measured(first.velocity_m_s)) {
    const double difference_m_s = velocity_m_s - first.velocity_m_s.value;
    velocity_difference_square_.add(difference_m_s * difference_m_s);
  }
  if (!estimates_noise_) return;
  at_limit_ += row.events.has(Event::noise_at_limit) ? 1U : 0U;
  const AxisEstimate<double>& axis = row.axes[axis_of(row)];
  noise_variance_m2_.add(axis.noise_sd_m * axis.noise_sd_m);
  jerk_.add(axis.jerk_density_m2_s5);
}

RunReport RunStatistics::report() const {
  RunReport report;
  report.missing = missing_;
  report.rejected = rejected_;
  if (samples_ > 0) {
    report.measured_share =
        static_cast<double>(velocity_square_.count()) / static_cast<double>(samples_);
  }
  report.error_rms_m = std::sqrt(error_square_m2_.mean());
  report.error_median_m = error_m_.quantile(0.5);
  report.score = score_.mean();
  report.score_difference = score_difference_.report(kIntervalShare);

  report.mean_nis = nis_.mean();
  report.nis_samples = nis_.count();
  report.nis_bounds = mean_chi_square_bounds(1, nis_.count(), kIntervalShare);
  report.correlation = pairs_ > 0 ? monitor_.innovation_correlation() : EstimateRow::kNone;
  report.is_whiteness_judged =
      static_cast<double>(pairs_) >= InnovationMonitor<double>::kFewestPairs;
  report.is_correlated = monitor_.is_correlated();
  report.is_filtered = monitor_.is_filtered();

  report.range_m = position_m_.highest - position_m_.lowest;
  report.velocity_rms_m_s = std::sqrt(velocity_square_.mean());
  report.velocity_peak_up_m_s = up_m_s_.quantile(kPeakShare);
  report.velocity_peak_down_m_s = down_m_s_.quantile(kPeakShare);
  report.velocity_difference_m_s = std::sqrt(velocity_difference_square_.mean());

  // At its lowest or highest value the noise is not known, nor if it is not white.
  const bool is_noise_known =
      2 * at_limit_ <= noise_variance_m2_.count() && !report.is_filtered && !report.is_correlated;
  report.noise_sd_m = is_noise_known ? std::sqrt(noise_variance_m2_.mean()) : EstimateRow::kNone;
  report.jerk_density_m2_s5 = is_noise_known ? jerk_.mean() : EstimateRow::kNone;
  report.friction_Ns_m = friction_Ns_m_;
  report.mass_kg = mass_kg_;
  return report;
}

}  // namespace condyle::host
