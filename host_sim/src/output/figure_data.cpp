// SPDX-License-Identifier: Apache-2.0
#include "output/figure_data.h"

#include <algorithm>

namespace condyle::host {
namespace {

FigureCurve curve_of(const Quantity<double>& quantity) {
  FigureCurve curve;
  if (quantity.provenance == Provenance::not_computed) return curve;
  const double half_width = kNormalQuantile95 * quantity.standard_deviation;
  curve.value.add(quantity.value);
  curve.band.add(quantity.value - half_width);
  curve.band.add(quantity.value + half_width);
  curve.provenance = quantity.provenance;
  return curve;
}

void merge(FigureCurve& curve, const FigureCurve& other) {
  curve.value.add(other.value);
  curve.band.add(other.band);
  curve.provenance = std::min(curve.provenance, other.provenance);
}

void merge(FigureRun& run, const FigureRun& other) {
  run.measured_position_m.add(other.measured_position_m);
  run.differentiated_velocity_m_s.add(other.differentiated_velocity_m_s);
  merge(run.position_m, other.position_m);
  merge(run.velocity_m_s, other.velocity_m_s);
  merge(run.force_N, other.force_N);
  merge(run.friction_Ns_m, other.friction_Ns_m);
  merge(run.mass_kg, other.mass_kg);
  run.has_event = run.has_event || other.has_event;
}

}  // namespace

void FigureData::add(const EstimateRow& row) {
  if (!row.time_ns) return;  // it cannot be placed on the time axis
  FigureRun run;
  if (!origin_ns_) origin_ns_ = row.time_ns;
  run.time_s = seconds(*row.time_ns - *origin_ns_);
  if (std::isfinite(row.measured_position_m)) {
    run.measured_position_m.add(row.measured_position_m);
    if (previous_ && *row.time_ns > previous_->time_ns) {
      run.differentiated_velocity_m_s.add((row.measured_position_m - previous_->position_m) /
                                          seconds(*row.time_ns - previous_->time_ns));
    }
    previous_ = Measured{*row.time_ns, row.measured_position_m};
  }
  run.position_m = curve_of(row.position_m);
  run.velocity_m_s = curve_of(row.velocity_m_s);
  run.force_N = curve_of(row.force_N);
  run.friction_Ns_m = curve_of(row.friction_Ns_m);
  run.mass_kg = curve_of(row.mass_kg);
  run.has_event = !row.events.empty();

  if (!runs_.empty() && samples_in_last_run_ < samples_per_run_) {
    merge(runs_.back(), run);
    ++samples_in_last_run_;
    return;
  }
  if (runs_.size() == kMostRuns) {  // merge neighbours, to halve their number
    for (std::size_t i = 0; i < kMostRuns / 2; ++i) {
      runs_[i] = runs_[2 * i];
      merge(runs_[i], runs_[2 * i + 1]);
    }
    runs_.resize(kMostRuns / 2);
    samples_per_run_ *= 2;
  }
  runs_.push_back(run);
  samples_in_last_run_ = 1;
}

}  // namespace condyle::host
