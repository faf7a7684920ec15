// SPDX-License-Identifier: Apache-2.0
// The convex hull of points in space.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace condyle::host {

struct ConvexHull {
  double volume;                         ///< in the cube of the points' unit
  std::vector<Eigen::Vector3d> corners;  ///< all points, if they lie in a plane
};

/// The convex hull of `points`. What exceeds it, or a plane, by less than 1e-9 of the points'
/// extent is not told from it. Quickhull (Barber, Dobkin, Huhdanpaa 1996): n log n for n points.
ConvexHull convex_hull(const std::vector<Eigen::Vector3d>& points);

}  // namespace condyle::host
