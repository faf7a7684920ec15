// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

namespace condyle::host {

/// A function of time of quintic pieces, constant between them; 0 at first. Position and velocity
/// are continuous, and so is acceleration where neighbouring pieces agree on it.
class SmoothTrack {
 public:
  /// From the present value to `target` between the instants, at rest at both ends, with these
  /// accelerations there. With none it has the smallest jerk. Must not begin before the last piece
  /// has ended.
  void move_to(double target, double begin_s, double end_s, double begin_acceleration = 0,
               double end_acceleration = 0);
  double at(double time_s) const;
  double last_value() const { return pieces_.empty() ? 0 : pieces_.back().end_value; }

 private:
  struct Piece {
    double begin_s, end_s, end_value;
    std::array<double, 6> coefficients;  // of powers of the share of the piece's duration
  };
  std::vector<Piece> pieces_;
};

}  // namespace condyle::host
