// SPDX-License-Identifier: Apache-2.0
#include "evaluation/error_statistics.h"

#include <algorithm>
#include <cmath>

namespace condyle::host {
namespace {
void add_mean(Moments& runs, const Moments& run) {
  if (run.count() > 0) runs.add(run.mean());
}
}  // namespace

void RunErrors::add(double error, double standard_deviation) {
  add(error, standard_deviation, std::abs(error) <= kNormalQuantile95 * standard_deviation);
}

void RunErrors::add(double error, double standard_deviation, bool covered) {
  if (std::isfinite(error)) {
    error_.add(error);
    square_.add(error * error);
  }
  const double normalised = error / standard_deviation;
  const bool usable =
      std::isfinite(normalised) && std::isfinite(standard_deviation) && standard_deviation > 0;
  covered_.add(usable && covered ? 1 : 0);
  if (usable) {
    normalised_square_.add(normalised * normalised);
  } else {
    ++unusable_;
  }
}

void ErrorStatistics::add_run(const RunErrors& run) {
  add_mean(error_, run.error_);
  add_mean(square_, run.square_);
  add_mean(covered_, run.covered_);
  add_mean(normalised_square_, run.normalised_square_);
  samples_ += run.covered_.count();
  unusable_ += run.unusable_;
}

void ErrorStatistics::merge(const ErrorStatistics& later) {
  error_.merge(later.error_);
  square_.merge(later.square_);
  covered_.merge(later.covered_);
  normalised_square_.merge(later.normalised_square_);
  samples_ += later.samples_;
  unusable_ += later.unusable_;
}

Interval ErrorStatistics::coverage_interval(double confidence) const {
  if (covered_.count() == 0) return {0, 1};
  const double N = static_cast<double>(covered_.count()), n = static_cast<double>(samples_);
  const double p = covered_.mean();
  double trials = N;
  const double variance = covered_.spread() / N;
  if (variance > 0 && N > 1) {
    const double tail = (1 - confidence) / 2;
    const double adjustment = student_t_quantile(tail, n - 1) / student_t_quantile(tail, N - 1);
    trials = std::min(n, p * (1 - p) / variance * adjustment * adjustment);
  }
  return proportion_interval(p * trials, trials, confidence);
}

ErrorReport ErrorStatistics::report(double confidence) const {
  ErrorReport report;
  report.runs = covered_.count();
  report.samples = samples_;
  report.unusable = unusable_;
  report.rms = std::sqrt(square_.mean());
  report.rms_standard_error = report.rms > 0 ? square_.standard_error() / (2 * report.rms) : 0;
  report.bias = error_.mean();
  report.bias_standard_error = error_.standard_error();
  report.coverage = covered_.mean();
  report.coverage_interval = coverage_interval(confidence);
  report.coverage_is_nominal = report.coverage_interval.contains(kNominalCoverage);
  report.mean_normalised_square = normalised_square_.mean();
  report.mean_normalised_square_standard_error = normalised_square_.standard_error();
  report.normalised_square_bounds =
      mean_chi_square_bounds(1, normalised_square_.count(), confidence);
  report.normalised_square_is_inside =
      unusable_ == 0 && report.normalised_square_bounds.contains(report.mean_normalised_square);
  return report;
}

}  // namespace condyle::host
