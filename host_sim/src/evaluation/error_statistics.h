// SPDX-License-Identifier: Apache-2.0
// Error of an estimated scalar over Monte-Carlo runs, and whether its stated uncertainty is right.
//
//   e    error, estimate - truth              s    standard deviation claimed for it
//   N    runs                                 n*   effective number of independent samples
//
// The samples of one run depend on each other, the runs do not. So each run is reduced to its means
// (of e, e^2, the covered share, e^2/s^2), each run counts once, and the standard errors come from
// the scatter between runs. With one sample in each run every interval is the textbook's.
//
// Coverage: Korn and Graubard (1998, Survey Methodology 24(2), 193-201), the Clopper-Pearson
// interval for n* = p (1 - p) / var(p) trials times (t_{n-1} / t_{N-1})^2, var(p) from the scatter
// between runs, n all samples. If all runs agree exactly, their scatter carries no information and
// n* is N.
#pragma once

#include <cstdint>

#include "condyle/estimator/provenance.h"
#include "statistics/chi_square.h"
#include "statistics/moments.h"

namespace condyle::host {

/// Nominal coverage of the intervals of this report.
inline constexpr double kNominalCoverage = 0.95;
/// Half width of a normal interval of nominal coverage, in standard deviations.

/// One quantity during one run.
class RunErrors {
 public:
  /// Takes the error and the standard deviation claimed for it, both in the quantity's unit. The
  /// interval is estimate +- kNormalQuantile95 standard deviations.
  void add(double error, double standard_deviation);
  /// The same for an estimate whose reported interval differs.
  void add(double error, double standard_deviation, bool covered);

  /// Calls `visit` with each number that it consists of, for files.
  template <class Visit>
  void visit_numbers(Visit&& visit) {
    for (Moments* moments : {&error_, &square_, &covered_, &normalised_square_}) {
      moments->visit_numbers(visit);
    }
    visit(unusable_);
  }

 private:
  friend class ErrorStatistics;
  Moments error_, square_, covered_, normalised_square_;
  std::uint64_t unusable_ = 0;
};

/// The result of one quantity. Units: the quantity's, unless stated otherwise.
struct ErrorReport {
  std::uint64_t runs = 0;         ///< with samples
  std::uint64_t samples = 0;      ///< of all runs
  std::uint64_t unusable = 0;     ///< among them: error or s not finite, or s not positive
  double rms = 0;                 ///< over the finite errors
  double rms_standard_error = 0;  ///< to first order
  double bias = 0;                ///< mean error
  double bias_standard_error = 0;
  double coverage = 0;                ///< share of the samples; an unusable one is not covered
  Interval coverage_interval;         ///< of the true coverage
  bool coverage_is_nominal = false;   ///< kNominalCoverage lies within coverage_interval
  double mean_normalised_square = 0;  ///< 1 if s is right
  double mean_normalised_square_standard_error = 0;
  /// Of mean_normalised_square for normal errors, each run counted as one independent sample: exact
  /// for one sample a run, wide for more.
  Interval normalised_square_bounds;
  bool normalised_square_is_inside = false;  ///< never with unusable samples
};

/// One quantity over many runs. Constant memory.
class ErrorStatistics {
 public:
  void add_run(const RunErrors& run);
  /// Appends the runs of `later`.
  void merge(const ErrorStatistics& later);
  /// Intervals and bounds hold with probability `confidence`.
  ErrorReport report(double confidence) const;

 private:
  Interval coverage_interval(double confidence) const;
  Moments error_, square_, covered_, normalised_square_;  // of the runs' means
  std::uint64_t samples_ = 0, unusable_ = 0;
};

}  // namespace condyle::host
