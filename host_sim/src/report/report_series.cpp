// SPDX-License-Identifier: Apache-2.0
#include "report/report_series.h"

#include <algorithm>
#include <cmath>

namespace condyle::host {

void ReportSeries::Curve::add(const Quantity<double>& quantity) {
  if (quantity.provenance == Provenance::not_computed) return;
  const auto value = static_cast<float>(quantity.value);
  add({value, value, static_cast<float>(kNormalQuantile95 * quantity.standard_deviation),
       quantity.provenance == Provenance::assumed});
}

void ReportSeries::Curve::add(const Curve& other) {
  // std::fmin and std::fmax return the number if the other argument is none.
  low = std::fmin(low, other.low);
  high = std::fmax(high, other.high);
  half = std::fmax(half, other.half);
  is_assumed = is_assumed || other.is_assumed;
}

void ReportSeries::add_to(Run& run, const EstimateRow& row) {
  const auto add = [&](Chart chart, std::size_t axis, const Quantity<double>& quantity) {
    run.curves[chart][axis].add(quantity);
    ++provenances_[chart][static_cast<std::size_t>(quantity.provenance)];
  };
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(row.axis_count); ++axis) {
    add(position, axis, row.axes[axis].position_m);
    add(velocity, axis, row.axes[axis].velocity_m_s);
    add(acceleration, axis, row.axes[axis].acceleration_m_s2);
  }
  // Only what the drive measured: a prior would look like a result.
  if (!row.has_impedance) return;
  if (row.friction_Ns_m.provenance == Provenance::measured) add(friction, 0, row.friction_Ns_m);
  if (row.mass_kg.provenance == Provenance::measured) add(mass, 0, row.mass_kg);
}

Provenance ReportSeries::provenance(Chart chart) const {
  const auto& counts = provenances_[chart];
  const auto most = std::max_element(counts.begin() + 1, counts.end());
  return *most > 0 ? static_cast<Provenance>(most - counts.begin()) : Provenance::not_computed;
}

void ReportSeries::add(const EstimateRow& row) {
  events_.add(row.events);
  if (!row.time_ns || is_duplicate(row) || row.events.has(Event::time_reversed)) return;
  const double time_s = seconds(*row.time_ns);
  if (is_unexpected(row.events) && event_times_s_.size() < most_runs_) {
    event_times_s_.push_back(time_s);
  }
  axis_count_ = std::max(axis_count_, row.axis_count);
  const bool follows_gap = row.events.has(Event::time_gap) && !runs_.empty();
  if (follows_gap) begin_run((runs_.back().time_s + time_s) / 2);  // without values
  if (runs_.empty() || follows_gap || samples_in_last_run_ >= samples_per_run_) begin_run(time_s);
  add_to(runs_.back(), row);
  ++samples_in_last_run_;
}

void ReportSeries::begin_run(double time_s) {
  if (runs_.size() >= most_runs_) halve();
  runs_.emplace_back();
  runs_.back().time_s = time_s;
  samples_in_last_run_ = 0;
}

// Every two runs become one.
void ReportSeries::halve() {
  for (std::size_t i = 0; i < runs_.size() / 2; ++i) {
    Run run = runs_[2 * i];
    for (std::size_t chart = 0; chart < kCharts; ++chart) {
      for (std::size_t axis = 0; axis < kAxes; ++axis) {
        run.curves[chart][axis].add(runs_[2 * i + 1].curves[chart][axis]);
      }
    }
    runs_[i] = run;
  }
  runs_.resize(runs_.size() / 2);
  samples_per_run_ *= 2;
}

}  // namespace condyle::host
