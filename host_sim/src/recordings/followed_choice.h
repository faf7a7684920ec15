// SPDX-License-Identifier: Apache-2.0
// Which coordinate of a facebow's samples is followed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "condyle/estimator/pose/point_follower.h"
#include "condyle/estimator/sample.h"

namespace condyle::host {

/// The user's choice of a point of the instrument or of the jaw, and of an axis.
struct FollowedChoice {
  FollowedCoordinate followed;
  bool axis_given = false;
  std::vector<double>
      jaw_point_mm;  ///< x, y, z in the jaw's frame; empty: a point of the instrument

  /// Throws InputError if samples of `kind`, from `source`, lack it.
  void check(const std::string& source, SampleKind kind) const;
  /// The point; `fits`: see FollowedPoint.
  FollowedPoint point(BodyFits* fits = nullptr) const;
  /// Of samples of `kind`: "one axis"; "point 1, axis z"; "jaw point (0, 80, 40) mm, axis z".
  std::string text(SampleKind kind) const;
};

/// The followed coordinate of one sample after the other, without an estimator.
class FollowedPositions {
 public:
  explicit FollowedPositions(const FollowedChoice& choice)
      : choice_(choice), follower_(choice.point()) {}

  /// The position in this sample (m).
  std::optional<double> position_m(const Sample& sample);

 private:
  FollowedChoice choice_;
  PointFollower<double> follower_;
};

}  // namespace condyle::host
