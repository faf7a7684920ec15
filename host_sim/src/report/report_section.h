// SPDX-License-Identifier: Apache-2.0
// What a report shows of one recording.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "readings/analysis.h"
#include "report/report_series.h"

namespace condyle::host {

/// The readings, the estimates over time and what they rest on.
struct ReportSection {
  std::optional<Analysis> analysis;  ///< none: `no_readings` says why
  std::string no_readings;
  std::optional<Landmarks> landmarks;
  ReportSeries series;
  std::string summary;                ///< of the estimates, as `condyle replay` prints it
  std::vector<std::string> warnings;  ///< about the estimates
  std::string recording, format;
  std::vector<std::string> notes;
  /// Subtracted from the times of charts: 0, or the first time of a clock with a distant origin.
  double origin_s = 0;
};

/// Reads the recording at `source` twice: for the readings, and for the estimates with a lag of
/// kReportLag_s. Throws InputError if it cannot be read. `progress`: called with 0 to 1.
ReportSection report_section(const std::string& source, const AnalysisChoice& choice,
                             const std::function<void(double)>& progress,
                             const std::function<bool()>& should_stop);

/// Estimates of a report use the samples of this time after their own.
inline constexpr double kReportLag_s = 0.05;

}  // namespace condyle::host
