// SPDX-License-Identifier: Apache-2.0
// What a report shows of one recording.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "condyle/estimator/impedance/impedance_estimate.h"
#include "condyle/estimator/impedance/impedance_parameters.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "estimation/drive_statement.h"
#include "readings/analysis.h"
#include "report/recording_identity.h"
#include "report/report_series.h"

namespace condyle::host {

/// What to report, and how.
struct ReportChoice {
  AnalysisChoice analysis;
  FollowedChoice followed;  ///< point and axis of the charts, and of a drive
  DriveStatement drive;     ///< statements about a drive
  std::string drive_file;   ///< of a recording without a drive of its own; empty: none
  std::string tasks_file;   ///< where `analysis` has its tasks from; empty: not from a file
};

/// The readings, the estimates over time and what they rest on.
struct ReportSection {
  std::optional<Analysis> analysis;  ///< none: `no_readings` says why
  std::string no_readings;
  RecordingIdentity identity;
  std::optional<Landmarks> landmarks;
  ReportSeries series{kMostRuns};
  ReportSeries fine{kMostFineRuns};  ///< for a closer look
  std::string summary;               ///< of the estimates, as `condyle replay` prints it
  std::string estimates_json;        ///< the same as data
  std::optional<ImpedanceEstimate<double>> impedance;  ///< from a measured drive
  ImpedanceParameters impedance_parameters;
  std::optional<RecommendedParameters> parameters;  ///< of the estimates; none: no estimates
  int lag = 0;                                      ///< of the estimates (samples)
  std::vector<std::string> warnings;                ///< about the estimates
  std::string recording, format;
  std::vector<std::string> notes;
  /// Of the usable samples of a recording that has no `analysis`.
  std::vector<double> sample_times_s;
  /// Subtracted from the times of charts: 0, or the first time of a clock with a distant origin.
  double origin_s = 0;

  static constexpr std::size_t kMostRuns = 16'384, kMostFineRuns = 65'536;
};

/// Reads the recording at `source` twice: for the readings, and for the estimates with a lag of
/// kReportLag_s. Throws InputError if it cannot be read. `progress`: called with 0 to 1, and like
/// `should_stop` on the caller's thread; the readings are computed on others.
ReportSection report_section(const std::string& source, const ReportChoice& choice,
                             const std::function<void(double)>& progress,
                             const std::function<bool()>& should_stop);

/// Estimates of a report use the samples of this time after their own.
inline constexpr double kReportLag_s = 0.05;

}  // namespace condyle::host
