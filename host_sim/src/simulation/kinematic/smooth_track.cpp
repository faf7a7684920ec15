// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/smooth_track.h"

#include <algorithm>

namespace condyle::host {

void SmoothTrack::move_to(double target, double begin_s, double end_s, double begin_acceleration,
                          double end_acceleration) {
  const double start = last_value(), way = target - start, duration_s = end_s - begin_s;
  // Accelerations per square of the share of the duration.
  const double first = begin_acceleration * duration_s * duration_s;
  const double last = end_acceleration * duration_s * duration_s;
  pieces_.push_back({begin_s,
                     end_s,
                     target,
                     {start, 0, first / 2, 10 * way - 1.5 * first + 0.5 * last,
                      -15 * way + 1.5 * first - last, 6 * way - 0.5 * first + 0.5 * last}});
}

double SmoothTrack::at(double time_s) const {
  const auto after =
      std::upper_bound(pieces_.begin(), pieces_.end(), time_s,
                       [](double time, const Piece& piece) { return time < piece.begin_s; });
  if (after == pieces_.begin()) return 0;
  const Piece& piece = *std::prev(after);
  if (time_s >= piece.end_s) return piece.end_value;
  const double share = (time_s - piece.begin_s) / (piece.end_s - piece.begin_s);
  double value = 0;
  for (std::size_t i = 6; i-- > 0;) value = value * share + piece.coefficients[i];
  return value;
}

}  // namespace condyle::host
