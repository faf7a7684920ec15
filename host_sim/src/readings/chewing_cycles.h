// SPDX-License-Identifier: Apache-2.0
// Chewing cycles: from one most closed instant to the next.
//
//   z    height of the incisor (m), smoothed; the jaw closes upward
//   d    rise and fall that make a cycle: 2 mm, and 0.3 of the 90th percentile of the heights
//   closed instant   the top of z, or the middle of the time near the top if that is long. Where
//                    the jaw pauses, a cycle ends with the arrival and the next one begins with the
//                    departure: the zero of a cubic law through the passages of two depths below
//                    the top. A pause: closed for 0.5 s and twice the median closed time
// A cycle is not taken, but listed, if it lasts less than 0.25 s or more than 3 s, has a gap of
// more than 0.1 s, or lies only partly within the task.
#pragma once

#include <string>
#include <vector>

#include "readings/path_measures.h"
#include "readings/reading.h"
#include "readings/reading_geometry.h"

namespace condyle::host {

/// The closed time in which a cycle begins or ends.
struct CycleEdge {
  bool is_pause = false;
  /// Of a pause: uncertainty of the time at which it begins or ends. Else of the middle of the
  /// closed time; 0 of an instant.
  double sd_s = 0;
  bool is_slow = false;  ///< the jaw reaches or leaves it too slowly for the law of departures
  double reads_s = 0;    ///< time to which the closed time and its far end reach
};

/// A cycle, as samples of the path in which it was found.
struct ChewingCycle {
  std::size_t begin = 0, turn = 0, end = 0;  ///< closed, most open, closed
  double begin_s = 0, turn_s = 0, end_s = 0;
  CycleEdge begins, ends;
  double open_s = 0;     ///< from leaving the closed position to reaching it again
  std::string rejected;  ///< why it is not taken; empty: taken
};

/// The cycles in the `window` of `height_m` at `time_s`; `noise_sd_m`: of a smoothed height. What
/// lies outside the window shows where its first cycle began and its last one ended.
std::vector<ChewingCycle> find_cycles(const std::vector<double>& time_s,
                                      const std::vector<double>& height_m, double noise_sd_m,
                                      SampleRun window);

/// Which side a cycle chews on, and how its loop turns.
struct CycleDirections {
  UncertainValue closing_side_mm, frontal_area_mm2, sagittal_area_mm2;  ///< cycle_shape.h
  UncertainValue begin_shift_s;  ///< from ChewingCycle::begin_s to the closed instant
};

/// The names of a cycle's readings, in the order of read_cycle.
std::vector<std::string_view> readings_of_cycle(bool has_landmarks);

/// Reach of the means whose top is a cycle's greatest value (s).
inline constexpr double kCycleTopReach_s = 0.06;

/// The readings of `cycle` from the `path` of its samples and some around, which begins with sample
/// `offset` of the path in which it was found. `greatest`: of values at these samples, with the
/// reach kCycleTopReach_s. With landmarks the values of CycleDirections follow those of
/// readings_of_cycle. Last are the doubts of arc lengths (smoothness.h) and the shortfalls of
/// greatest values (shortfalls.h).
void read_cycle(const ChewingCycle& cycle, std::size_t offset, double noise_sd_m,
                bool has_landmarks, const JawPath& path, const GreatestAt& greatest,
                std::vector<double>& values, std::vector<std::string>* why);

/// The height of the incisor along the path: Z, or without landmarks the direction in which it
/// moves most.
std::vector<double> heights_of(const JawPath& path, bool has_landmarks);

}  // namespace condyle::host
