// SPDX-License-Identifier: Apache-2.0
// How an estimate responds to a change of the truth: the least-squares line estimate = a + b truth.
// b is 1 for an estimate that follows, 0 for one that does not depend on it.
#pragma once

#include <cstdint>

#include "statistics/chi_square.h"

namespace condyle::host {

/// The fitted line. Slope without unit, intercept in the quantity's.
struct SlopeReport {
  std::uint64_t pairs = 0, unusable = 0;  ///< unusable: not finite, left out of the fit
  double slope = 0;                       ///< NaN if the truth did not vary
  double slope_standard_error = 0;        ///< from the residuals; infinite below three pairs
  Interval slope_interval;                ///< Student's t on pairs - 2 degrees of freedom
  double intercept = 0;
};

/// Collects pairs. They must be independent: one from each run. Constant memory.
class ResponseSlope {
 public:
  void add(double truth, double estimate);
  /// Appends the pairs of `later`.
  void merge(const ResponseSlope& later);
  SlopeReport report(double confidence) const;

 private:
  std::uint64_t count_ = 0, unusable_ = 0;
  double mean_x_ = 0, mean_y_ = 0;         // x truth, y estimate
  double S_xx_ = 0, S_xy_ = 0, S_yy_ = 0;  // sums of products of distances from the means
};

}  // namespace condyle::host
