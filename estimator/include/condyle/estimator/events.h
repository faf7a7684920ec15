// SPDX-License-Identifier: Apache-2.0
// Named events: everything unusual about a sample or a step is flagged and counted as one of these.
#pragma once

#include <cstddef>
#include <cstdint>

namespace condyle {

/// Unusual properties of a sample (first group) or of the estimator's step (second group).
enum class Event : std::uint8_t {
  time_missing,      ///< the sample has no time
  time_reversed,     ///< earlier than the last accepted sample; not passed to the estimator
  time_restarted,    ///< the third such sample in a row, in order: the clock was set back; accepted
  time_repeated,     ///< same time as the last accepted sample
  time_gap,          ///< more than 1.5 nominal steps after the last accepted sample
  position_missing,  ///< a coordinate is empty, NaN or infinite; the estimator only predicts
  zero_filled,       ///< the followed point is exactly (0, 0, 0); the estimator only predicts
  drive_missing,     ///< the drive force is empty, NaN or infinite
  not_started,       ///< no position has been measured yet
  update_refused,    ///< an innovation variance was not positive and finite; nothing was updated
  estimate_not_finite,  ///< a state is not finite
  variance_negative,    ///< a variance is negative
  parameters_invalid,   ///< a parameter is out of its range; nothing is computed
  position_repeated,    ///< a position repeated as living devices seldom do; only predicted
  position_frozen,      ///< the device repeats a position; the estimator only predicts
  points_not_rigid,     ///< the three points have changed their distances; not used
  outlier_weighted,     ///< far from the prediction: has less weight
  outlier_rejected,     ///< too far from the prediction: not used
  outlier_revoked,      ///< shows that the previous sample was an outlier: its use is revoked
  state_restarted,      ///< the filter restarts from this sample
  state_lost,           ///< no measurement for so long that the state is unknown
  noise_at_limit,       ///< the estimated noise is at its floor or ceiling
  motion_changed,  ///< departs from the motion so far, and is accepted as a change of the motion
  liveliness_at_limit,    ///< jerk density is at the highest value that can be told from noise
  position_out_of_range,  ///< a coordinate is beyond 10 m: treated as missing
};
/// Number of events.
inline constexpr std::size_t kEventCount = 25;

/// Name of an event in files and summaries.
constexpr const char* event_name(Event event) {
  constexpr const char* names[kEventCount] = {"time_missing",
                                              "time_reversed",
                                              "time_restarted",
                                              "time_repeated",
                                              "time_gap",
                                              "position_missing",
                                              "zero_filled",
                                              "drive_missing",
                                              "not_started",
                                              "update_refused",
                                              "estimate_not_finite",
                                              "variance_negative",
                                              "parameters_invalid",
                                              "position_repeated",
                                              "position_frozen",
                                              "points_not_rigid",
                                              "outlier_weighted",
                                              "outlier_rejected",
                                              "outlier_revoked",
                                              "state_restarted",
                                              "state_lost",
                                              "noise_at_limit",
                                              "motion_changed",
                                              "liveliness_at_limit",
                                              "position_out_of_range"};
  return names[static_cast<std::size_t>(event)];
}

/// A set of events.
class EventSet {
 public:
  /// Adds `event` if `condition` holds.
  constexpr void add(Event event, bool condition = true) {
    if (condition) bits_ |= std::uint32_t{1} << static_cast<unsigned>(event);
  }
  /// Adds all events of `other`.
  constexpr void add(EventSet other) { bits_ |= other.bits_; }
  /// True if `event` is in the set.
  constexpr bool has(Event event) const {
    return ((bits_ >> static_cast<unsigned>(event)) & 1U) != 0;
  }
  /// True if nothing unusual happened.
  constexpr bool empty() const { return bits_ == 0; }

 private:
  std::uint32_t bits_ = 0;
};

/// True if a sample departed from the predicted motion: an outlier or a change. Its innovation
/// gives no information on the instrument's noise.
constexpr bool is_unexpected(EventSet events) {
  return events.has(Event::outlier_rejected) || events.has(Event::motion_changed);
}

/// How often each event happened.
class EventCounts {
 public:
  /// Counts each event of `events` once.
  constexpr void add(EventSet events) {
    for (std::size_t i = 0; i < kEventCount; ++i) {
      if (events.has(static_cast<Event>(i))) ++counts_[i];
    }
  }
  /// Adds the counts of `other`.
  constexpr void add(const EventCounts& other) {
    for (std::size_t i = 0; i < kEventCount; ++i) counts_[i] += other.counts_[i];
  }
  /// How often `event` happened.
  constexpr std::uint64_t operator[](Event event) const {
    return counts_[static_cast<std::size_t>(event)];
  }

 private:
  std::uint64_t counts_[kEventCount] = {};
};

}  // namespace condyle
