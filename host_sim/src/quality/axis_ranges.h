// SPDX-License-Identifier: Apache-2.0
// The range of a point's motion along each axis: the middle 95 % of its positions, so that glitches
// have no effect; of fewer than 41, all of them. In long recordings only every second, fourth, ...
// position is used.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace condyle::host {

/// Of one point. Constant memory.
class AxisRanges {
 public:
  /// Maximum number of stored positions.
  static constexpr std::size_t kMost = 4096;

  /// Adds a position (m).
  void add(const std::array<double, 3>& position_m);
  /// Width of the middle 95 % of the positions along each axis (m); 0 before the first.
  std::array<double, 3> ranges_m() const;

 private:
  std::vector<std::array<double, 3>> kept_m_;
  std::uint64_t count_ = 0, stride_ = 1;
};

/// The axis along which a point moves at least `ratio` times as far as along `followed`, and by at
/// least `least_m`: the one with the longest range. `followed` if there is none.
std::size_t livelier_axis(const std::array<double, 3>& ranges_m, std::size_t followed, double ratio,
                          double least_m);

}  // namespace condyle::host
