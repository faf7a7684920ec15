// SPDX-License-Identifier: Apache-2.0
#include "quality/axis_ranges.h"

#include <algorithm>
#include <cmath>

#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr double kLeftOut = 0.025;   // share of the positions at each end
constexpr std::size_t kFewest = 41;  // positions of which none is more than this share

}  // namespace

void AxisRanges::add(const std::array<double, 3>& position_m) {
  if (count_++ % stride_ != 0) return;
  kept_m_.push_back(position_m);
  if (kept_m_.size() < kMost) return;
  for (std::size_t i = 0; 2 * i < kMost; ++i) kept_m_[i] = kept_m_[2 * i];
  kept_m_.resize(kMost / 2);
  stride_ *= 2;
}

std::array<double, 3> AxisRanges::ranges_m() const {
  std::array<double, 3> ranges_m{};
  if (kept_m_.empty()) return ranges_m;
  const std::size_t last = kept_m_.size() - 1;
  const auto left_out = static_cast<std::size_t>(
      kept_m_.size() < kFewest ? 0 : std::ceil(kLeftOut * static_cast<double>(last)));
  std::vector<double> along(kept_m_.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::transform(kept_m_.begin(), kept_m_.end(), along.begin(),
                   [axis](const auto& position_m) { return position_m[axis]; });
    ranges_m[axis] = sorted_at(along, last - left_out) - sorted_at(along, left_out);
  }
  return ranges_m;
}

std::size_t livelier_axis(const std::array<double, 3>& ranges_m, std::size_t followed, double ratio,
                          double least_m) {
  const auto longest = static_cast<std::size_t>(std::max_element(ranges_m.begin(), ranges_m.end()) -
                                                ranges_m.begin());
  const bool is_livelier =
      ranges_m[longest] >= least_m && ranges_m[longest] >= ratio * ranges_m[followed];
  return is_livelier ? longest : followed;
}

}  // namespace condyle::host
