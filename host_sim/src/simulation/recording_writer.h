// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "simulation/simulation.h"

namespace condyle::host {

/// Converts simulated data to rows of CSV: all digits, units in the column names. Each row is valid
/// until the next.
class RecordingWriter {
 public:
  explicit RecordingWriter(const Scenario& scenario) : scenario_(scenario) {}

  std::string recording_header() const;
  std::string_view recording_row(const Sample& sample);
  std::string truth_header() const;
  std::string_view truth_row(const SubjectTruth& truth);
  std::string drive_header() const { return "time_s,drive_N\n"; }
  std::string head_header() const { return "time_s,acceleration_m_s2\n"; }
  /// Row of a companion with one value: force sensor or accelerometer.
  std::string_view value_row(const Reading& reading);
  std::string emg_header() const;
  std::string_view emg_row(const Reading& reading);

 private:
  const Scenario& scenario_;
  std::string row_;
};

}  // namespace condyle::host
