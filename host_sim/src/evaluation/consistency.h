// SPDX-License-Identifier: Apache-2.0
// Consistency of a filter: does its covariance equal that of its errors?
//
//   e, P   error of the state (estimate - truth) and its claimed covariance
//   y, S   innovation and its claimed covariance
//   NEES   e' P^-1 e, normalised estimation error squared: chi-square with n degrees of freedom
//   NIS    y' S^-1 y, normalised innovation squared: chi-square with m degrees of freedom
//
// if the model holds (Bar-Shalom, Li and Kirubarajan 2001, Estimation with Applications to Tracking
// and Navigation, section 5.4). Their averages over Monte-Carlo runs are compared with the bounds
// of an average of independent chi-squares. Innovations of a consistent filter are independent in
// time; its errors are not.
#pragma once

#include <Eigen/Cholesky>
#include <cstdint>
#include <limits>

#include "statistics/chi_square.h"
#include "statistics/moments.h"

namespace condyle::host {

/// x' C^-1 x; NaN if `covariance` is not positive definite.
template <int n>
double normalised_square(const Eigen::Matrix<double, n, 1>& x,
                         const Eigen::Matrix<double, n, n>& covariance) {
  const Eigen::LLT<Eigen::Matrix<double, n, n>> factor(covariance);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  return factor.matrixL().solve(x).squaredNorm();
}

/// Normalised squares of one run.
class RunSquares {
 public:
  /// A value that is not finite and non-negative is counted as unusable.
  void add(double normalised_square);

  /// Calls `visit` with each number that it consists of, for files.
  template <class Visit>
  void visit_numbers(Visit&& visit) {
    square_.visit_numbers(visit);
    visit(unusable_);
  }

 private:
  friend class ConsistencyStatistics;
  Moments square_;
  std::uint64_t unusable_ = 0;
};

/// Result of averaging normalised squares. Without unit.
struct ConsistencyReport {
  std::uint64_t runs = 0, terms = 0, unusable = 0;
  double mean = 0;
  double standard_error = 0;  ///< of the mean, from the scatter between runs
  Interval bounds;            ///< of the mean, for a consistent filter
  bool inside = false;        ///< never with unusable terms
};

/// Averages normalised squares over many runs. Constant memory.
class ConsistencyStatistics {
 public:
  /// Which terms count as independent chi-squares.
  enum class Independent {
    runs,  ///< NEES. Bounds: exact for one term in each run, wide for more
    terms  ///< NIS
  };
  ConsistencyStatistics(int degrees_of_freedom, Independent independent)
      : degrees_of_freedom_(degrees_of_freedom), independent_(independent) {}

  void add_run(const RunSquares& run);
  /// Appends the runs of `later`, of the same kind.
  void merge(const ConsistencyStatistics& later);
  /// A consistent filter is inside with probability `confidence`.
  ConsistencyReport report(double confidence) const;

 private:
  int degrees_of_freedom_;
  Independent independent_;
  Moments run_mean_, term_;
  std::uint64_t unusable_ = 0;
};

}  // namespace condyle::host
