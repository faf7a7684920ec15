// SPDX-License-Identifier: Apache-2.0
// Real recordings of motion, and what can happen to them on their way to the estimator.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace condyle::testing_support {

/// Positions of one point, x, y, z (m); NaN where missing.
struct RealRecording {
  std::string name;
  std::vector<double> time_s;
  std::array<std::vector<double>, 3> position_m;

  std::size_t size() const { return time_s.size(); }
  /// True where all of sample `i` was recorded.
  bool is_measured(std::size_t i) const;
  /// Median time step (s).
  double step_s() const;
};

/// The recordings of the reference data whose licence fits this project's, by name; empty where
/// there are no reference data.
std::vector<RealRecording> read_real_recordings();

/// What is done to a recording.
enum class Treatment { none, every_second, every_fourth, rounded_0_1_mm, rounded_0_01_mm, faults };
/// For messages.
const char* name_of(Treatment treatment);

/// A recording after its treatment; `is_spoiled` marks samples that a fault has changed or taken.
struct TreatedRecording {
  RealRecording recording;
  RealRecording clean;  ///< the same without faults
  std::vector<bool> is_spoiled;
};
/// Faults: one after the other, single and double glitches of 10 to 100 % of the range, dropouts of
/// 0.1 to 0.3 s, positions frozen for 0.5 s, one in 1.1 s.
TreatedRecording treat(const RealRecording& recording, Treatment treatment);

}  // namespace condyle::testing_support
