// SPDX-License-Identifier: Apache-2.0
// When a jaw was closed, and when it left and reached that position.
//
//   z   height of the incisor (m); the jaw closes upward
#pragma once

#include <cstddef>
#include <vector>

#include "readings/sample_run.h"

namespace condyle::host {

/// Depth below the top (m) that counts as closed, in a cycle of `height_m`.
double closed_depth_m(double height_m, double noise_sd_m);

/// When z, going from `from` in steps of `way`, first lies at `level_m`, interpolated; the last
/// time if it never does.
double passage_s(const std::vector<double>& time_s, const std::vector<double>& z, std::size_t from,
                 int way, double level_m);

/// The law of departures goes through a depth and one this many times as deep.
inline constexpr double kDepthsOfLaw = 4;

/// When the departure in direction `way` from a closed jaw began, if it grows with the third power
/// of time, as movements of least jerk do: the zero of that law through two depths. `last`: the
/// last closed sample.
double departure_s(const std::vector<double>& time_s, const std::vector<double>& z,
                   std::size_t last, int way, double top_m, double depth_m);

/// How far two of those laws, through nearer and through further depths, disagree (s): movements
/// that arrive more slowly than that have no such zero. `height_m`: of the cycle.
double departure_doubt_s(const std::vector<double>& time_s, const std::vector<double>& z,
                         std::size_t last, int way, double top_m, double depth_m, double height_m);

/// The middle between arrival and departure (s) around the closed sample `at`. Where a jaw closes
/// fast and opens slowly, the passages of one depth, which stand for them if `is_slow`, lie to the
/// slow side of it.
double middle_of_closed_s(const std::vector<double>& time_s, const std::vector<double>& z,
                          std::size_t at, double top_m, double depth_m, bool is_slow);

/// The samples near a top.
struct ClosedTime {
  std::size_t first, top, last;
  bool is_cut;       ///< the recording or a gap begins or ends in it
  bool is_in_cycle;  ///< the window begins or ends below a top that lies outside
};

/// Closed times in a window of a path. What lies outside continues them.
class ClosedTimes {
 public:
  /// `longest_gap_s`: what counts as seen. Refers to the arguments.
  ClosedTimes(const std::vector<double>& time_s, const std::vector<double>& z, SampleRun window,
              double longest_gap_s)
      : time_s_(time_s), z_(z), window_(window), longest_gap_s_(longest_gap_s) {}

  /// All samples less than `depth_m` below z[top] between the turns `floor` and `roof`; beyond the
  /// window, those that follow one another.
  ClosedTime around(std::size_t top, std::size_t floor, std::size_t roof, double depth_m) const;

  double length_s(const ClosedTime& closed) const {
    return time_s_[closed.last] - time_s_[closed.first];
  }

 private:
  bool ends_at(std::size_t k, int way) const;

  const std::vector<double>& time_s_;
  const std::vector<double>& z_;
  SampleRun window_;
  double longest_gap_s_;
};

}  // namespace condyle::host
