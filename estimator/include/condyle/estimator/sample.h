// SPDX-License-Identifier: Apache-2.0
// One sample of a facebow, and the check of a sample against the one before it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "condyle/estimator/events.h"

namespace condyle {

/// Time in nanoseconds from an origin that the source chooses. Differences are taken as integers,
/// before conversion: float seconds at 24 h move in steps of 8 ms.
using TimeNs = std::int64_t;

/// Nanoseconds in a second.
inline constexpr TimeNs kNanosecondsPerSecond = 1'000'000'000;

/// `duration_ns` in seconds.
constexpr double seconds(TimeNs duration_ns) {
  return static_cast<double>(duration_ns) * 1e-9;
}

/// `duration_s` in nanoseconds, rounded to the nearest; `duration_s` within +-9.2e9 s.
inline TimeNs nanoseconds(double duration_s) {
  return static_cast<TimeNs>(std::llround(duration_s * 1e9));
}

/// What a sample's coordinates are, metres throughout.
enum class SampleKind : std::uint8_t {
  one_axis,      ///< coordinates[0]: position along one axis
  one_point,     ///< coordinates[0..2]: x, y, z
  three_points,  ///< coordinates[0..8]: x, y, z of points 1, 2, 3
  pose,          ///< coordinates[0..2]: x, y, z; [3..6]: unit quaternion w, x, y, z
};

/// Number of coordinates of a sample of `kind`.
constexpr std::size_t coordinate_count(SampleKind kind) {
  switch (kind) {
    case SampleKind::one_axis:
      return 1;
    case SampleKind::one_point:
      return 3;
    case SampleKind::three_points:
      return 9;
    case SampleKind::pose:
      return 7;
  }
  return 0;
}

/// One sample as a source delivers it. A value that is not there is marked, never invented.
struct Sample {
  TimeNs time_ns = 0;          ///< instant of the measurement
  std::uint64_t sequence = 0;  ///< counts the source's samples, lost ones included
  SampleKind kind = SampleKind::one_axis;
  double coordinates[9] = {};  ///< see SampleKind (m; quaternion without unit)
  double drive_N = 0;          ///< measured total drive along the followed axis
  bool time_valid = true;
  bool position_valid = true;  ///< all coordinates are finite numbers
  bool drive_valid = false;    ///< a drive force was measured with this sample
};

/// An axis of the instrument's frame.
enum class Axis : std::uint8_t { x, y, z };

/// The coordinate that a one-dimensional estimator follows.
struct FollowedCoordinate {
  int point = 1;        ///< 1 to 3; only three_points has more than one
  Axis axis = Axis::z;  ///< not used by one_axis
};

/// True where samples of `kind` have the followed coordinate.
constexpr bool is_available(SampleKind kind, FollowedCoordinate followed) {
  const int points = kind == SampleKind::three_points ? 3 : 1;
  return followed.point >= 1 && followed.point <= points;
}

/// The followed coordinate of `sample` in metres. `is_available` must hold.
constexpr double followed_position_m(const Sample& sample, FollowedCoordinate followed) {
  if (sample.kind == SampleKind::one_axis) return sample.coordinates[0];
  const int first = sample.kind == SampleKind::three_points ? 3 * (followed.point - 1) : 0;
  return sample.coordinates[first + static_cast<int>(followed.axis)];
}

/// Compares each sample with the one before it.
class SampleChecker {
 public:
  /// `nominal_step_ns`: expected time between samples; 0 finds no gaps. `expects_drive`: a sample
  /// without a drive force is an event.
  constexpr explicit SampleChecker(TimeNs nominal_step_ns = 0, bool expects_drive = false)
      : gap_ns_(nominal_step_ns + nominal_step_ns / 2), expects_drive_(expects_drive) {}

  /// Events of `sample`, which becomes the one that the next is compared with.
  constexpr EventSet check(const Sample& sample) {
    EventSet events;
    events.add(Event::time_missing, !sample.time_valid);
    events.add(Event::position_missing, !sample.position_valid);
    events.add(Event::drive_missing, expects_drive_ && !sample.drive_valid);
    if (sample.time_valid) {
      if (has_previous_) {
        events.add(Event::time_reversed, sample.time_ns < previous_time_ns_);
        events.add(Event::time_repeated, sample.time_ns == previous_time_ns_);
        // Unsigned, because the difference of two far times can leave int64.
        const std::uint64_t step_ns = static_cast<std::uint64_t>(sample.time_ns) -
                                      static_cast<std::uint64_t>(previous_time_ns_);
        events.add(Event::time_gap, sample.time_ns > previous_time_ns_ && gap_ns_ > 0 &&
                                        step_ns > static_cast<std::uint64_t>(gap_ns_));
      }
      previous_time_ns_ = sample.time_ns;
      has_previous_ = true;
    }
    // Along one axis an exact zero is an ordinary position.
    bool all_zero = sample.position_valid && sample.kind != SampleKind::one_axis;
    for (std::size_t i = 0; all_zero && i < coordinate_count(sample.kind); ++i) {
      all_zero = sample.coordinates[i] == 0;
    }
    events.add(Event::zero_filled, all_zero && previous_all_zero_);
    previous_all_zero_ = all_zero;
    return events;
  }

 private:
  TimeNs gap_ns_;
  bool expects_drive_;
  bool has_previous_ = false;
  bool previous_all_zero_ = false;
  TimeNs previous_time_ns_ = 0;
};

}  // namespace condyle
