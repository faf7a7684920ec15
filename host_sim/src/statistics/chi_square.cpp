// SPDX-License-Identifier: Apache-2.0
#include "statistics/chi_square.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <limits>

namespace condyle::host {
namespace {
// long double differs between machines.
using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using Normal = boost::math::normal_distribution<double, Policy>;
using ChiSquare = boost::math::chi_squared_distribution<double, Policy>;
using StudentT = boost::math::students_t_distribution<double, Policy>;
}  // namespace

double normal_distribution(double x) {
  return boost::math::cdf(Normal(), x);
}

double normal_quantile(double probability) {
  return boost::math::quantile(Normal(), probability);
}

double chi_square_distribution(double x, double degrees_of_freedom) {
  return boost::math::cdf(ChiSquare(degrees_of_freedom), x);
}

double chi_square_quantile(double probability, double degrees_of_freedom) {
  return boost::math::quantile(ChiSquare(degrees_of_freedom), probability);
}

double student_t_distribution(double x, double degrees_of_freedom) {
  return boost::math::cdf(StudentT(degrees_of_freedom), x);
}

double student_t_quantile(double probability, double degrees_of_freedom) {
  return boost::math::quantile(StudentT(degrees_of_freedom), probability);
}

Interval mean_chi_square_bounds(double degrees_of_freedom, std::uint64_t runs, double confidence) {
  if (runs == 0) return {0, std::numeric_limits<double>::infinity()};
  // The sum is chi-square with the summed degrees of freedom.
  const double count = static_cast<double>(runs), tail = (1 - confidence) / 2;
  const ChiSquare sum(count * degrees_of_freedom);
  return {boost::math::quantile(sum, tail) / count,
          boost::math::quantile(boost::math::complement(sum, tail)) / count};
}

Interval proportion_interval(double hits, double trials, double confidence) {
  const double misses = trials - hits, tail = (1 - confidence) / 2;
  Interval interval{0, 1};
  if (hits > 0) interval.low = boost::math::ibeta_inv(hits, misses + 1, tail, Policy());
  if (misses > 0) interval.high = boost::math::ibetac_inv(hits + 1, misses, tail, Policy());
  return interval;
}

}  // namespace condyle::host
