// SPDX-License-Identifier: Apache-2.0
// A rigid body of three or more named points, some of which may be missing.
//
//   s_i, p_i   the points in the body's frame, whose origin is their middle, and in the
//   instrument's pose       R, t that minimise sum |R s_i + t - p_i|^2 over the points that are
//   there (Kabsch
//              1976: singular value decomposition of sum (p_i - p)(s_i - s)')
//   shape      medians over the samples of R' (p_i - t), from the sample whose distances are
//   nearest
//              to their medians
//   growth     what missing points add to the noise: the greatest ratio of the variance of a
//              combination of the pose's six components with and without them, for points of equal
//              and independent noise
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

namespace condyle::host {

/// Points of one sample, one a column (m); NaN for a missing one.
using PointColumns = Eigen::Matrix3Xd;

/// Pose of a body in one sample.
struct BodyFit {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< body's frame -> instrument's
  double residual_rms_m = 0;                               ///< over the points that are there
  double growth = 1;                                       ///< of the variance; see above
  bool is_fitted = false;  ///< three points are there that span a triangle
};

/// Most points of one body.
inline constexpr std::size_t kMostBodyPoints = 60;

class PointBody {
 public:
  /// Learns the shape from `samples`, each with the points called `names`. Throws an InputError
  /// that names `place` if they span no triangle, or if one of them is never there.
  PointBody(const std::vector<PointColumns>& samples, const std::vector<std::string>& names,
            const std::string& place);
  /// The body with the points `shape_m`, all there, which become relative to their middle.
  explicit PointBody(const PointColumns& shape_m);

  /// Relative to their middle, one a column (m).
  const PointColumns& shape_m() const { return shape_m_; }
  BodyFit fit(const PointColumns& points_m) const;

 private:
  double growth_of(const PointColumns& points_m) const;

  PointColumns shape_m_;
  mutable std::map<std::uint64_t, double> growths_;  // by the points that are there
};

/// Mean of the `poses` from `begin` to `end` (without), which differ by small rotations.
Eigen::Isometry3d mean_pose(const std::vector<Eigen::Isometry3d>& poses, std::size_t begin,
                            std::size_t end);

}  // namespace condyle::host
