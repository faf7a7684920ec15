// SPDX-License-Identifier: Apache-2.0
// Running moments by Welford's recurrence, merged by that of Chan, Golub and LeVeque: constant
// memory, no cancellation. Merging in one order gives one result, bit for bit.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace condyle::host {

/// Count, mean and variance of numbers.
class Moments {
 public:
  void add(double value) { merge({1, value, 0}); }

  void merge(const Moments& later) {
    if (later.count_ == 0) return;
    const double all = static_cast<double>(count_ + later.count_);
    const double share = static_cast<double>(later.count_) / all;
    const double step = later.mean_ - mean_;
    squares_ += later.squares_ + step * step * static_cast<double>(count_) * share;
    mean_ += step * share;
    count_ += later.count_;
  }

  std::uint64_t count() const { return count_; }
  /// NaN without numbers.
  double mean() const { return count_ > 0 ? mean_ : std::numeric_limits<double>::quiet_NaN(); }
  /// Mean squared distance from the mean, over count.
  double spread() const { return squares_ / static_cast<double>(count_); }
  /// Of the mean, from the scatter of the numbers; infinite for fewer than two.
  double standard_error() const {
    if (count_ < 2) return std::numeric_limits<double>::infinity();
    return std::sqrt(spread() / static_cast<double>(count_ - 1));
  }

  Moments() = default;

  /// Calls `visit` with each number that it consists of, for files.
  template <class Visit>
  void visit_numbers(Visit&& visit) {
    visit(count_);
    visit(mean_);
    visit(squares_);
  }

 private:
  Moments(std::uint64_t count, double mean, double squares)
      : count_(count), mean_(mean), squares_(squares) {}

  std::uint64_t count_ = 0;
  double mean_ = 0, squares_ = 0;  // squares: sum of squared distances from the mean
};

}  // namespace condyle::host
