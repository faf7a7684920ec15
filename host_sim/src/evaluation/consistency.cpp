// SPDX-License-Identifier: Apache-2.0
#include "evaluation/consistency.h"

#include <cmath>

namespace condyle::host {

void RunSquares::add(double normalised_square) {
  if (std::isfinite(normalised_square) && normalised_square >= 0) {
    square_.add(normalised_square);
  } else {
    ++unusable_;
  }
}

void ConsistencyStatistics::add_run(const RunSquares& run) {
  if (run.square_.count() > 0) run_mean_.add(run.square_.mean());
  term_.merge(run.square_);
  unusable_ += run.unusable_;
}

void ConsistencyStatistics::merge(const ConsistencyStatistics& later) {
  run_mean_.merge(later.run_mean_);
  term_.merge(later.term_);
  unusable_ += later.unusable_;
}

ConsistencyReport ConsistencyStatistics::report(double confidence) const {
  const Moments& averaged = independent_ == Independent::runs ? run_mean_ : term_;
  ConsistencyReport report;
  report.runs = run_mean_.count();
  report.terms = term_.count() + unusable_;
  report.unusable = unusable_;
  report.mean = averaged.mean();
  report.standard_error = run_mean_.standard_error();
  report.bounds = mean_chi_square_bounds(degrees_of_freedom_, averaged.count(), confidence);
  report.inside = unusable_ == 0 && report.bounds.contains(report.mean);
  return report;
}

}  // namespace condyle::host
