// SPDX-License-Identifier: Apache-2.0
// Error of an estimate, and its claimed standard deviation, over the course of a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace condyle::host {

/// Root mean squares of error and claimed standard deviation in equal intervals of time. Constant
/// memory.
class ErrorOverTime {
 public:
  /// Over runs that last `duration_s`; without it, nothing is collected until one is merged.
  explicit ErrorOverTime(double duration_s = 0);

  /// Error and claimed standard deviation at `time_s` of a run; values that are not finite are left
  /// out.
  void add(double time_s, double error, double standard_deviation);
  /// Adds the values of `later`, of the same duration.
  void merge(const ErrorOverTime& later);

  /// The result of one interval of time. Units: the quantity's.
  struct Stretch {
    double middle_s = 0;  ///< time
    double error_rms = 0, claimed_rms = 0;
  };
  /// The intervals of time that have values, in order.
  std::vector<Stretch> stretches() const;

 private:
  static constexpr std::size_t kStretches = 150;
  struct Sums {
    double error_square = 0, variance = 0;
    std::uint64_t count = 0;
  };
  double duration_s_;
  std::vector<Sums> sums_;
};

}  // namespace condyle::host
