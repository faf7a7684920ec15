// SPDX-License-Identifier: Apache-2.0
// The sums of products, in blocks, that the regression of point_regression.h keeps of a recording.
//
//   a, v, x        acceleration, velocity, position, through the kernel (m/s^2, m/s, m)
//   1              the kernel's own sum, about 1
//   X              x in units of 5 mm, from the place where the recording began
//   q2, q3, q4     X^2, X^3, X^4 of each sample, through the kernel: a spring that is not linear
//   q_s            the smooth sign of the velocity of each sample, likewise: sliding friction
//   u', u'', u     the drive, and its derivatives (N/s, N/s^2, N), through the kernel
//   M_b            sums of the products of each two of them over the instants of block b
//
// Blocks:  each starts with as many instants as make half a second. When all are full, neighbours
//          are merged and the later ones hold twice as much: kBlocks / 2 to kBlocks of them, for
//          any duration, whose scatter shows how well a sum is known (the interval of
//          regression_fit.h).
// Noise:   of the products, from the kernel's gains and the variances that the samples' differences
//          showed within the block. That of q2, q3, q4 is to first order X' noise, with the slopes
//          2 X, 3 X^2, 4 X^3: it needs the sums of X to X^6.
#pragma once

#include <array>

#include "condyle/estimator/impedance/noise_difference.h"
#include "condyle/estimator/math/modulating_kernel.h"

namespace condyle {

/// The columns, in the order of the symbols above.
enum RegressionColumn : std::uint8_t {
  kAccelerationColumn,
  kVelocityColumn,
  kPositionColumn,
  kOneColumn,
  kSquareColumn,
  kCubeColumn,
  kFourthColumn,
  kSignColumn,
  kDriveSlopeColumn,
  kDriveCurvatureColumn,
  kDriveColumn,
  kRegressionColumns
};

/// Unit of X (m).
inline constexpr double kShapeUnit_m = 5e-3;

/// Sums over some instants.
template <class Scalar>
struct RegressionSums {
  static constexpr std::size_t kProducts = kRegressionColumns * (kRegressionColumns + 1) / 2;
  static constexpr std::size_t kPowers = 6;
  static constexpr std::size_t kSize = kProducts + kPowers + 5 + kNoiseLags;

  std::array<Scalar, kProducts> products{};       ///< see `product`
  std::array<Scalar, kPowers> powers{};           ///< of X, X^2 ... X^6
  NoiseSums<Scalar> position_noise, drive_noise;  ///< of the samples (m^2, N^2)
  NoiseLagSums<Scalar> position_colour{};
  Scalar instants = 0;

  static constexpr std::size_t place(std::size_t i, std::size_t j) {
    const std::size_t low = i < j ? i : j, high = i < j ? j : i;
    return low * kRegressionColumns - low * (low + 1) / 2 + high;
  }
  /// Sum of column i times column j.
  Scalar product(std::size_t i, std::size_t j) const { return products[place(i, j)]; }

  void add_instant(const std::array<Scalar, kRegressionColumns>& columns) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < kRegressionColumns; ++i) {
      for (std::size_t j = i; j < kRegressionColumns; ++j) {
        products[next++] += columns[i] * columns[j];
      }
    }
    const Scalar X = columns[kPositionColumn] / Scalar(kShapeUnit_m);
    Scalar power = 1;
    for (Scalar& sum : powers) sum += (power *= X);
    instants += Scalar(1);
  }

  template <class Other>
  void add(const RegressionSums<Other>& other) {
    for (std::size_t i = 0; i < kProducts; ++i) products[i] += Scalar(other.products[i]);
    for (std::size_t i = 0; i < kPowers; ++i) powers[i] += Scalar(other.powers[i]);
    position_noise.add(other.position_noise);
    drive_noise.add(other.drive_noise);
    for (std::size_t i = 0; i < kNoiseLags; ++i) {
      position_colour[i] += Scalar(other.position_colour[i]);
    }
    instants += Scalar(other.instants);
  }
};

/// The blocks of a recording. Fixed size, no allocation.
template <class Scalar>
class RegressionBlocks {
 public:
  static constexpr std::size_t kBlocks = 64;
  static constexpr double kFirstBlock_s = 0.5;

  /// `instant_s`: time from instant to instant.
  explicit RegressionBlocks(double instant_s)
      : instants_per_block_(static_cast<Scalar>(
            instant_s < kFirstBlock_s ? static_cast<int>(kFirstBlock_s / instant_s + 0.5) : 1)) {}

  /// The block being filled; call `close_if_full` after each instant.
  RegressionSums<Scalar>& open() { return blocks_[count_]; }
  void close_if_full() {
    if (blocks_[count_].instants < instants_per_block_) return;
    if (++count_ < kBlocks) {
      blocks_[count_] = {};
      return;
    }
    for (std::size_t k = 0; k < kBlocks / 2; ++k) {
      if (k > 0) blocks_[k] = blocks_[2 * k];
      blocks_[k].add(blocks_[2 * k + 1]);
    }
    count_ = kBlocks / 2;
    blocks_[count_] = {};
    instants_per_block_ *= Scalar(2);
  }

  /// Number of full blocks, and one of them.
  std::size_t size() const { return count_; }
  const RegressionSums<Scalar>& operator[](std::size_t block) const { return blocks_[block]; }

 private:
  Scalar instants_per_block_;
  std::array<RegressionSums<Scalar>, kBlocks + 1> blocks_{};
  std::size_t count_ = 0;
};

}  // namespace condyle
