// SPDX-License-Identifier: Apache-2.0
// Distributions for judging a filter's consistency, computed by Boost.Math in double precision.
// Arguments outside a function's domain throw std::domain_error or std::overflow_error.
#pragma once

#include <cstdint>

namespace condyle::host {

/// A closed interval; its ends have the unit of what it bounds.
struct Interval {
  double low = 0, high = 0;
  /// False for NaN.
  bool contains(double value) const { return low <= value && value <= high; }
};

/// Share of a standard normal variable below `x`.
double normal_distribution(double x);
/// The x below which a standard normal variable stays with probability `probability`, in (0, 1).
double normal_quantile(double probability);

/// Share of a chi-square variable with `degrees_of_freedom` > 0 below `x` >= 0.
double chi_square_distribution(double x, double degrees_of_freedom);
/// The x below which a chi-square variable stays with probability `probability`, in [0, 1).
double chi_square_quantile(double probability, double degrees_of_freedom);

/// Share of Student's t with `degrees_of_freedom` > 0 below `x`.
double student_t_distribution(double x, double degrees_of_freedom);
/// The x below which Student's t with `degrees_of_freedom` > 0 stays with probability
/// `probability`, in (0, 1).
double student_t_quantile(double probability, double degrees_of_freedom);

/// Two-sided bounds of the average of `runs` independent chi-square variables with
/// `degrees_of_freedom` each: the average leaves them with probability 1 - `confidence`, half of
/// it on each side. `runs` = 0 gives [0, infinity].
Interval mean_chi_square_bounds(double degrees_of_freedom, std::uint64_t runs, double confidence);

/// Clopper-Pearson interval of a probability after `hits` in `trials` independent trials: it covers
/// the truth with at least `confidence`. Numbers need not be whole, for effective numbers of
/// trials. `trials` = 0 gives [0, 1].
Interval proportion_interval(double hits, double trials, double confidence);

}  // namespace condyle::host
