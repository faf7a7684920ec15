// SPDX-License-Identifier: Apache-2.0
// One sample of a facebow, and its check against the samples before it.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>

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

/// `later_ns` minus `earlier_ns` (s). Unsigned: the difference of two far times can leave int64.
template <class Scalar>
constexpr Scalar difference_s(TimeNs later_ns, TimeNs earlier_ns) {
  const std::uint64_t difference_ns =
      static_cast<std::uint64_t>(later_ns) - static_cast<std::uint64_t>(earlier_ns);
  return static_cast<Scalar>(static_cast<double>(difference_ns) * 1e-9);
}

/// `duration_s` in nanoseconds, rounded to the nearest; `duration_s` within +-9.2e9 s.
inline TimeNs nanoseconds(double duration_s) {
  return static_cast<TimeNs>(std::llround(duration_s * 1e9));
}

/// Meaning of a sample's coordinates, all in metres.
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

/// No jaw tracker measures beyond this distance from its origin (m): such a number stands for a
/// missing value.
inline constexpr double kFarthestPosition_m = 10;

/// True if one of `coordinates` of a sample of `kind` is a finite length beyond
/// kFarthestPosition_m. The source then marks the position as not valid.
constexpr bool is_out_of_range(SampleKind kind, const double* coordinates) {
  const std::size_t lengths = kind == SampleKind::pose ? 3 : coordinate_count(kind);
  // Compared as integers with the same order: some microcontrollers have no double. NaN comes after
  // infinity.
  constexpr auto kFarthest = std::bit_cast<std::uint64_t>(kFarthestPosition_m);
  constexpr auto kInfinity = std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < lengths; ++i) {
    const std::uint64_t size = std::bit_cast<std::uint64_t>(coordinates[i]) << 1U >> 1U;
    if (size > kFarthest && size < kInfinity) return true;
  }
  return false;
}

/// One sample as a source delivers it. A missing value is marked, never invented.
struct Sample {
  TimeNs time_ns = 0;          ///< instant of the measurement
  std::uint64_t sequence = 0;  ///< counts the source's samples, lost ones included
  SampleKind kind = SampleKind::one_axis;
  double coordinates[9] = {};  ///< see SampleKind (m; quaternion without unit)
  double drive_N = 0;          ///< measured total drive along the followed axis
  bool time_valid = true;
  bool position_valid = true;  ///< all coordinates were measured: finite, not is_out_of_range
  bool drive_valid = false;    ///< a drive force was measured with this sample
};

/// An axis of the instrument's frame.
enum class Axis : std::uint8_t { x, y, z };

/// The coordinate that a one-dimensional estimator follows.
struct FollowedCoordinate {
  int point = 1;        ///< 1 to 3; only three_points has more than one
  Axis axis = Axis::z;  ///< not used by one_axis
};

/// True if samples of `kind` have the followed coordinate.
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

/// Compares each sample with the previous ones.
class SampleChecker {
 public:
  /// `nominal_step_ns`: expected time between samples; 0 detects no gaps. `expects_drive`: a sample
  /// without a drive force is an event. `followed`: the point whose zeros are detected.
  constexpr explicit SampleChecker(TimeNs nominal_step_ns = 0, bool expects_drive = false,
                                   FollowedCoordinate followed = {})
      : gap_ns_(nominal_step_ns + nominal_step_ns / 2),
        expects_drive_(expects_drive),
        followed_(followed) {}

  /// Events of `sample`.
  constexpr EventSet check(const Sample& sample) {
    EventSet events;
    events.add(Event::time_missing, !sample.time_valid);
    events.add(Event::position_missing, !sample.position_valid);
    events.add(Event::position_out_of_range, is_out_of_range(sample.kind, sample.coordinates));
    events.add(Event::drive_missing, expects_drive_ && !sample.drive_valid);
    if (sample.time_valid) check_time(sample.time_ns, events);
    events.add(Event::zero_filled, is_zero_filled(sample));
    return events;
  }

 private:
  static constexpr int kRestartAfter = 3;
  static constexpr double kZeroJump_m = 1e-3;

  constexpr void check_time(TimeNs time_ns, EventSet& events) {
    if (has_time_ && time_ns < time_ns_) {
      reversed_in_order_ =
          reversed_in_order_ > 0 && time_ns >= last_reversed_ns_ ? reversed_in_order_ + 1 : 1;
      last_reversed_ns_ = time_ns;
      if (reversed_in_order_ < kRestartAfter) {
        events.add(Event::time_reversed);
        return;
      }
      events.add(Event::time_restarted);
    } else if (has_time_) {
      events.add(Event::time_repeated, time_ns == time_ns_);
      // Unsigned, because the difference of two far times can leave int64.
      const std::uint64_t step_ns =
          static_cast<std::uint64_t>(time_ns) - static_cast<std::uint64_t>(time_ns_);
      events.add(Event::time_gap, gap_ns_ > 0 && step_ns > static_cast<std::uint64_t>(gap_ns_));
    }
    reversed_in_order_ = 0;
    time_ns_ = time_ns;
    has_time_ = true;
  }

  // Devices fill dropouts with zeros. Exactly (0, 0, 0) counts as a dropout if the point comes from
  // more than a millimetre away, or stays. Along one axis, zero is a position like any other.
  constexpr bool is_zero_filled(const Sample& sample) {
    if (!sample.position_valid || sample.kind == SampleKind::one_axis ||
        !is_available(sample.kind, followed_)) {
      return false;
    }
    bool is_zero = true, is_near = true;
    for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
      const double position_m = followed_position_m(sample, {followed_.point, axis});
      is_zero = is_zero && position_m == 0;
      is_near = is_near && position_m < kZeroJump_m && position_m > -kZeroJump_m;
    }
    const bool is_filled = is_zero && has_position_ && (was_zero_ || !was_near_);
    has_position_ = true;
    was_zero_ = is_zero;
    was_near_ = is_near;
    return is_filled;
  }

  TimeNs gap_ns_;
  bool expects_drive_;
  FollowedCoordinate followed_;
  bool has_time_ = false;
  TimeNs time_ns_ = 0;  // of the last accepted sample
  int reversed_in_order_ = 0;
  TimeNs last_reversed_ns_ = 0;
  bool has_position_ = false, was_zero_ = false, was_near_ = false;
};

}  // namespace condyle
