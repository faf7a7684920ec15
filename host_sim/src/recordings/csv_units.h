// SPDX-License-Identifier: Apache-2.0
// Units that a CSV file does not state, as far as its values tell them: a jaw does not move by 15 m
// nor is it recorded at 200 kHz.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace condyle::host {

/// What the values of one column or more tell about their unit.
struct UnitGuess {
  double each = 0;        ///< metres or seconds; 0: the values do not tell
  std::string unit;       ///< "mm", "ms" ...
  std::string reason;     ///< why no other unit fits, or why none can be chosen
  bool is_count = false;  ///< steps of 1 from a whole number: it may be a frame number
};

/// The unit of times (NaN: missing) from their median step: s, ms, us or ns, if it makes 5 to
/// 5000 samples per second in one of them only.
UnitGuess guess_time_unit(const std::vector<double>& times);

/// The unit of coordinates, one series a column: mm or m.
UnitGuess guess_length_unit(const std::vector<std::vector<double>>& columns);

/// The unit of points, by name: none if one moves as if in mm and another as if in m.
UnitGuess guess_length_unit(const std::map<std::string, std::vector<std::vector<double>>>& points);

/// True for the numbers of rows, counted by ones, and for a column without any value.
bool is_counter_or_empty(const std::vector<double>& values);

/// Why times in units of `each` s cannot be the times of a recording.
struct TimesDoubt {
  std::string problem;     ///< empty: they can be
  std::string unit;        ///< "s", "ms" ..., which makes a usual rate; empty: no other does
  double each = 0;         ///< that unit in seconds
  bool is_absurd = false;  ///< too fast for whatever is recorded
};
TimesDoubt doubt_of_times(const std::vector<double>& times, double each);

/// Why positions (m) are no jaw's: most lie where none is, and would count as missing. Empty: they
/// may be.
std::string problem_of_distance(const std::vector<std::vector<double>>& columns_m);

/// Why coordinates (m) cannot be the places of a jaw; empty: they can.
std::string problem_of_places(const std::vector<std::vector<double>>& columns_m);

}  // namespace condyle::host
