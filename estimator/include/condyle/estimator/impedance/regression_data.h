// SPDX-License-Identifier: Apache-2.0
// The blocks that fits of a recording share (regression_fit.h), with the noise of their sums.
//
//   s_z^2     variance of a position's noise, by the block's own samples (point_regression.h)
//   G0 ... G4 the kernel's gains (modulating_kernel.h)
//
// Products:  of a, v, x: s_z^2 times G4 (a a), G2 (v v), -G2 (a x), G0 (x x); odd and even kernels
//            do not mix. Of u, u', u'' likewise with the drive's. Of X^k as of x, times the slope
//            k X^(k-1)
#pragma once

#include <utility>

#include "condyle/estimator/impedance/point_regression.h"

namespace condyle {

/// Shared by the fits of a recording: its blocks from `first` on, their sum, their noise.
template <class Scalar>
class RegressionData {
 public:
  RegressionData(const RegressionBlocks<Scalar>& blocks, const RegressionSetup& setup,
                 std::size_t first)
      : blocks_(blocks), setup_(setup), first_(first) {
    for (std::size_t b = first; b < blocks.size(); ++b) sum_.add(blocks[b]);
    position_share_ = sum_.instants / sum_.position_noise.count;
    drive_share_ = sum_.instants / sum_.drive_noise.count;
  }

  std::size_t size() const { return blocks_.size() - first_; }
  const RegressionSums<Scalar>& block(std::size_t b) const { return blocks_[first_ + b]; }
  const RegressionSums<double>& sum() const { return sum_; }
  const RegressionSetup& setup() const { return setup_; }
  double duration_s() const { return sum_.instants * setup_.instant_s; }
  /// Variances of a sample's noise (m^2, N^2).
  double position_variance_m2() const {
    return sum_.position_noise.variance / sum_.position_noise.count;
  }
  double drive_variance_N2() const { return sum_.drive_noise.variance / sum_.drive_noise.count; }

  /// True if the positions' noise is not white: at some lag the blocks' sums are farther from 0
  /// than their scatter allows, by chance once in 70 recordings of 8 s, 200 of 20 s, 1000 of a
  /// minute. A block that is much louder than the others counts as one of thrice their variance.
  /// The drive's noise needs no such test: it is in the residual.
  bool has_coloured_positions() const {
    constexpr double kBeyond = 4, kLoud = 3;
    const auto n = static_cast<double>(size());
    double inverses = 0;
    for (std::size_t b = 0; b < size(); ++b) {
      const auto variance = static_cast<double>(block(b).position_noise.variance);
      if (variance > 0) inverses += 1 / variance;
    }
    for (std::size_t lag = 0; lag < kNoiseLags; ++lag) {
      double sum = 0, squares = 0;
      for (std::size_t b = 0; b < size(); ++b) {
        const RegressionSums<Scalar>& of = block(b);
        const double loudness = static_cast<double>(of.position_noise.variance) * inverses / n;
        const double share = static_cast<double>(of.position_colour[lag]) *
                             (loudness > kLoud ? kLoud / loudness : 1);
        sum += share;
        squares += share * share;
      }
      if (sum * sum > kBeyond * kBeyond * (squares - sum * sum / n) * n / (n - 1)) return true;
    }
    return false;
  }

  /// Expected contribution of noise to the product of columns i and j of `sums`. The variance is
  /// that within the block, so that its own uncertainty is part of the scatter.
  template <class Sum>
  double noise(const RegressionSums<Sum>& sums, RegressionColumn i, RegressionColumn j) const {
    if (i > j) std::swap(i, j);
    const double z = static_cast<double>(sums.position_noise.variance) * position_share_,
                 u = static_cast<double>(sums.drive_noise.variance) * drive_share_;
    const KernelGains& of_z = setup_.position;
    const KernelGains& of_u = setup_.drive;
    if (i == kDriveSlopeColumn && j == kDriveSlopeColumn) return u * of_u.G2;
    if (i == kDriveColumn && j == kDriveColumn) return u * of_u.G0;
    if (i == kDriveCurvatureColumn && j == kDriveCurvatureColumn) return u * of_u.G4;
    if (i == kDriveCurvatureColumn && j == kDriveColumn) return -u * of_u.G2;
    if (i == kVelocityColumn && j == kVelocityColumn) return z * of_z.G2;
    if (i == kAccelerationColumn && j == kAccelerationColumn) return z * of_z.G4;
    if (i == kAccelerationColumn && j == kPositionColumn) return -z * of_z.G2;
    if (i == kPositionColumn && j == kPositionColumn) return z * of_z.G0;
    return of_powers(sums, i, j);
  }

 private:
  // X^k has the noise k X^(k-1) of X.
  static int power_of(RegressionColumn column) {
    return column == kSquareColumn   ? 2
           : column == kCubeColumn   ? 3
           : column == kFourthColumn ? 4
                                     : 0;
  }
  template <class Sum>
  double of_powers(const RegressionSums<Sum>& sums, RegressionColumn i, RegressionColumn j) const {
    const int k = power_of(j), l = power_of(i);
    if (k == 0) return 0;
    const auto power_sum = [&sums](int power) {
      return static_cast<double>(sums.powers[static_cast<std::size_t>(power - 1)]);
    };
    const double z = position_variance_m2() / kShapeUnit_m, slope = k * power_sum(k - 1) * z;
    if (i == kAccelerationColumn) return -slope * setup_.position.G2;
    if (i == kPositionColumn) return slope * setup_.position.G0;
    if (l == 0) return 0;
    return k * l * power_sum(k + l - 2) * z / kShapeUnit_m * setup_.position.G0;
  }

  const RegressionBlocks<Scalar>& blocks_;
  const RegressionSetup& setup_;
  std::size_t first_;
  RegressionSums<double> sum_;
  double position_share_, drive_share_;
};

}  // namespace condyle
