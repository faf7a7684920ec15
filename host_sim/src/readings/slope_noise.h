// SPDX-License-Identifier: Apache-2.0
// The noise of a slope: of a weighted sum of samples, alone in their noise or sharing it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "readings/shared_noise.h"

namespace condyle::host {

/// The places of a point, in the head frame (m).
using Places = std::vector<Eigen::Vector3d>;

/// A slope as a sum of weighted samples.
struct Slope {
  std::size_t first = 0;
  std::vector<double> weights;  ///< empty: too few samples there

  Eigen::Vector3d of(const Places& places) const;
  /// Variance over that of a sample whose neighbours share nothing with it.
  double gain() const;
  /// a this + b other.
  Slope mixed(double a, const Slope& other, double b) const;
};

/// Covariances of a point's samples: of each alone, and of each part that neighbours share.
struct PointNoise {
  Eigen::Matrix3d white;
  std::vector<Eigen::Matrix3d> shared;
};

/// The same of one coordinate.
struct NoiseAlong {
  double white = 0;
  std::vector<double> shared;  ///< covariance of samples that are 0, 1, 2, ... steps apart

  double variance_of(const Slope& slope) const;
};

/// Along the unit vector `direction`; `shared`: the parts, of samples `step_s` apart.
NoiseAlong along(const Eigen::Vector3d& direction, const PointNoise& noise,
                 const std::vector<SharedNoise>& shared, double step_s);
/// Of both coordinates at right angles to it together.
NoiseAlong across(const Eigen::Vector3d& direction, const PointNoise& noise,
                  const std::vector<SharedNoise>& shared, double step_s);

}  // namespace condyle::host
