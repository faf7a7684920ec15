// SPDX-License-Identifier: Apache-2.0
// The mean of successive numbers, and its uncertainty. Neighbours depend on each other, so the
// scatter is taken between the means of blocks. Blocks of one, two, four ... times the length are
// tried as long as kFewestBlocks remain, and the widest interval counts (H. Flyvbjerg and H. G.
// Petersen, J. Chem. Phys. 91 (1989) 461-466). Constant memory: too many blocks are merged in
// pairs.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "statistics/chi_square.h"
#include "statistics/moments.h"

namespace condyle::host {

/// A mean, in the unit of the numbers.
struct BlockMean {
  double mean = 0;            ///< NaN without numbers
  double standard_error = 0;  ///< that of `interval`; NaN if it is not known
  Interval interval;          ///< by Student's t; infinite if there are too few blocks
  std::uint64_t blocks = 0;   ///< that determine `interval`; 0: too few

  /// True if zero is not in the interval.
  bool differs_from_zero() const { return blocks > 0 && !interval.contains(0); }
};

class BlockMeans {
 public:
  static constexpr std::size_t kMostBlocks = 64, kFewestBlocks = 8;

  /// `block`: numbers in a block; 0 if no sufficient length is known: there is then no interval.
  explicit BlockMeans(std::uint64_t block) : block_(block) {}

  void add(double value) {
    all_.add(value);
    if (block_ == 0) return;
    sum_ += value;
    if (++in_sum_ < block_) return;
    means_[blocks_++] = sum_ / static_cast<double>(block_);
    sum_ = 0;
    in_sum_ = 0;
    if (blocks_ < kMostBlocks) return;
    blocks_ = halve(means_, blocks_);
    block_ *= 2;
  }

  std::uint64_t count() const { return all_.count(); }

  BlockMean report(double confidence) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    BlockMean result{
        all_.mean(), std::numeric_limits<double>::quiet_NaN(), {-kInfinity, kInfinity}, 0};
    double widest = -1;
    std::array<double, kMostBlocks> means = means_;
    for (std::size_t blocks = blocks_; blocks >= kFewestBlocks; blocks = halve(means, blocks)) {
      Moments moments;
      for (std::size_t i = 0; i < blocks; ++i) moments.add(means[i]);
      const double half_width =
          moments.standard_error() *
          student_t_quantile((1 + confidence) / 2, static_cast<double>(blocks - 1));
      if (half_width <= widest) continue;
      widest = half_width;
      result.standard_error = moments.standard_error();
      result.interval = {result.mean - half_width, result.mean + half_width};
      result.blocks = blocks;
    }
    return result;
  }

 private:
  // Merges blocks in pairs; returns their number. Leaves out an odd one at the end.
  static std::size_t halve(std::array<double, kMostBlocks>& means, std::size_t blocks) {
    for (std::size_t i = 0; i < blocks / 2; ++i) {
      means[i] = (means[2 * i] + means[2 * i + 1]) / 2;
    }
    return blocks / 2;
  }

  std::uint64_t block_, in_sum_ = 0;
  double sum_ = 0;
  std::array<double, kMostBlocks> means_ = {};
  std::size_t blocks_ = 0;
  Moments all_;
};

}  // namespace condyle::host
