// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace condyle::host {

/// Quantiles of numbers that are not negative, in constant memory: the mean of those within 0.2 %
/// of the quantile. Numbers below 1e-9 share one bin, those above 1e3 another.
class QuantileHistogram {
 public:
  QuantileHistogram() : bins_(kBins) {}

  void add(double value) {
    const double place = std::log(std::clamp(value, kLowest, kHighest) / kLowest) / kStep;
    Bin& bin = bins_[std::min(static_cast<std::size_t>(place), kBins - 1)];
    bin.sum += value;
    ++bin.count;
    ++count_;
  }
  std::uint64_t count() const { return count_; }
  /// The number that the share `probability` of all, 0 to 1, does not exceed; NaN without numbers.
  double quantile(double probability) const {
    if (count_ == 0) return std::numeric_limits<double>::quiet_NaN();
    const double rank = std::max(1.0, std::ceil(probability * static_cast<double>(count_)));
    std::uint64_t below = 0;
    std::size_t bin = 0;
    while (bin + 1 < kBins && static_cast<double>(below += bins_[bin].count) < rank) ++bin;
    return bins_[bin].sum / static_cast<double>(bins_[bin].count);
  }

 private:
  static constexpr double kLowest = 1e-9, kHighest = 1e3, kStep = 0.002;
  static constexpr std::size_t kBins = 13816;  // ln(kHighest / kLowest) / kStep

  struct Bin {
    std::uint64_t count = 0;
    double sum = 0;
  };
  std::vector<Bin> bins_;
  std::uint64_t count_ = 0;
};

}  // namespace condyle::host
