// SPDX-License-Identifier: Apache-2.0
#include "readings/whole_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "readings/local_fit.h"
#include "statistics/in_blocks.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kBlock = kSamplesInBlock;
constexpr std::array kParts = {&JawPath::incisor_m, &JawPath::incisor_m_s, &JawPath::rotation_rad,
                               &JawPath::middle_m};
constexpr std::array kCondylarParts = {&JawPath::condyle_m, &JawPath::condyle_m_s};

template <class Value>
void put(std::vector<Value>& all, std::size_t begin, const std::vector<Value>& block) {
  std::copy(block.begin(), block.end(), all.begin() + static_cast<std::ptrdiff_t>(begin));
}

// The greatest motion of some samples.
struct GreatestMotion {
  double rotation_rad = 0, displacement_m = 0;
};

// Puts the path of the samples from `begin` to `end` into `whole`.
GreatestMotion put_block(const ReferredMotion& motion, const ReadingGeometry& geometry,
                         const Matrix6& noise, std::size_t begin, std::size_t end,
                         WholePath& whole) {
  const LocalFit fit(motion.time_s, begin, end);
  SmoothMotion smooth{{motion.time_s.begin() + static_cast<std::ptrdiff_t>(begin),
                       motion.time_s.begin() + static_cast<std::ptrdiff_t>(end)},
                      {},
                      {}};
  fit.apply(motion.motion, 0, smooth.value, smooth.slope);
  TurningMotion turning;
  turning_of(smooth, turning);
  JawPath block;
  paths_of(smooth, turning, geometry, PathPart::all, block);
  if (begin == 0) {  // the same in all blocks
    whole.path.condyle_at_m = block.condyle_at_m;
    whole.path.incisor_at_m = block.incisor_at_m;
    whole.path.middle_at_m = block.middle_at_m;
  }
  for (const auto part : kParts) put(whole.path.*part, begin, block.*part);
  for (const auto part : kCondylarParts) {
    for (std::size_t side = 0; side < 2; ++side) {
      put((whole.path.*part)[side], begin, (block.*part)[side]);
    }
  }
  const Vector3d lever = geometry.incisor_m - geometry.middle_m;
  const std::vector<double> gains = fit.gains();
  GreatestMotion greatest;
  for (std::size_t k = 0; k < gains.size(); ++k) {
    const Vector6& value = smooth.value[k];
    greatest.rotation_rad = std::max(greatest.rotation_rad, value.tail<3>().norm());
    greatest.displacement_m = std::max(greatest.displacement_m, value.head<3>().norm());
    const Vector3d r = turning.rotation[k] * lever;
    Eigen::Matrix<double, 3, 6> J;
    J << Eigen::Matrix3d::Identity(),
        -Eigen::Matrix3d{{0, -r[2], r[1]}, {r[2], 0, -r[0]}, {-r[1], r[0], 0}};
    const double variance = (J * noise * J.transpose()).trace() / 3;
    whole.incisor_sd_m[begin + k] = std::sqrt(variance * gains[k]);
  }
  return greatest;
}

}  // namespace

WholePath whole_path(const ReferredMotion& motion, const ReadingGeometry& geometry,
                     const Matrix6& noise) {
  WholePath whole;
  const std::size_t count = motion.time_s.size();
  whole.path.time_s = motion.time_s;
  for (const auto part : kParts) (whole.path.*part).resize(count);
  for (const auto part : kCondylarParts) {
    for (auto& side : whole.path.*part) side.resize(count);
  }
  whole.incisor_sd_m.resize(count);
  std::vector<GreatestMotion> greatest((count + kBlock - 1) / kBlock);
  run_in_blocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
    greatest[begin / kBlock] = put_block(motion, geometry, noise, begin, end, whole);
  });
  for (const GreatestMotion& of_block : greatest) {
    whole.largest_rotation_rad = std::max(whole.largest_rotation_rad, of_block.rotation_rad);
    whole.largest_displacement_m = std::max(whole.largest_displacement_m, of_block.displacement_m);
  }
  return whole;
}

}  // namespace condyle::host
