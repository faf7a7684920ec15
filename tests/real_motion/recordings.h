// SPDX-License-Identifier: Apache-2.0
// Recordings of motion with what they are measured against, and what can happen to a recording on
// its way to the estimator.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace condyle::testing_support {

using Values = std::vector<double>;
using Marks = std::vector<bool>;

/// Positions of one point along its axes (m); NaN where missing.
struct MotionRecording {
  std::string name;
  std::string instrument;  ///< and its laboratory
  std::string source;      ///< where it is from, and its licence
  Values time_s;
  std::vector<Values> position_m;  ///< by axis: x, y, z, or one

  std::size_t size() const { return time_s.size(); }
  /// True where all of sample `i` was recorded.
  bool is_measured(std::size_t i) const;
  /// Median time step (s).
  double step_s() const;
};

/// The real recordings whose licence fits this project's, those of an instrument together; empty
/// where there are no reference data.
std::vector<MotionRecording> read_real_recordings();

/// What is done to a recording.
enum class Treatment { none, every_second, every_fourth, rounded_0_1_mm, rounded_0_01_mm, faults };
inline constexpr Treatment kTreatments[] = {
    Treatment::none,           Treatment::every_second,    Treatment::every_fourth,
    Treatment::rounded_0_1_mm, Treatment::rounded_0_01_mm, Treatment::faults};
/// For messages and tables.
const char* name_of(Treatment treatment);
inline void PrintTo(Treatment treatment, std::ostream* out) {
  *out << name_of(treatment);
}

/// A recording after its treatment.
struct TreatedRecording {
  MotionRecording recording;
  MotionRecording clean;  ///< the same without faults
  bool has_faults = false;

  /// True where a fault has changed or taken the value of sample `i`, or there was none.
  bool is_spoiled(std::size_t axis, std::size_t i) const;
};
/// Faults: one after the other, single glitches of 10 to 100 % of the range, dropouts of 0.1 to 0.3
/// s, positions frozen for 0.5 s and double glitches, one in 1.1 s. `seed` draws their sizes.
TreatedRecording treat(const MotionRecording& recording, Treatment treatment, unsigned seed = 1);

}  // namespace condyle::testing_support
