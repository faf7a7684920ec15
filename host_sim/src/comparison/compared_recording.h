// SPDX-License-Identifier: Apache-2.0
// Runs recordings through the compared estimators. All estimators see each sample in turn, so the
// memory does not depend on the length of a recording.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "comparison/compared_estimator.h"
#include "comparison/run_statistics.h"

namespace condyle::host {

/// An estimator and the user's name for it.
struct NamedEstimator {
  std::string name;
  EstimatorChoice option;
};

/// What to run, and how.
struct ComparisonPlan {
  std::vector<NamedEstimator> estimators;  ///< at least one; the first is the baseline
  RecordingChoice choice;
  DriveStatement drive;  ///< statements about a drive in the recordings
};

/// The result of one recording.
struct RecordingReport {
  std::string source, format;
  SampleKind kind = SampleKind::one_axis;
  std::uint64_t samples = 0, gaps = 0;
  double duration_s = 0;       ///< of the times in order
  double step_s = 0;           ///< expected between samples; 0: not known
  std::uint64_t compared = 0;  ///< samples that all estimators had predicted
  std::vector<std::string> notes;
  std::vector<RunReport> runs;  ///< one for each estimator
};

/// Progress of the work on recordings, and its stop condition.
struct ComparisonControl {
  std::function<void(double share)> progress;  ///< called on the caller's thread
  std::function<bool()> should_stop;           ///< called on any thread
};

/// Shortest blocks of samples that count as independent of each other: a few chewing cycles.
inline constexpr double kScoreBlock_s = 2;

/// The estimator of "recommended", "published", "recommended:FILE" or "published:FILE"; `lag` is
/// the recommended one's. Throws InputError for anything else.
NamedEstimator parse_estimator(const std::string& text, int lag);

/// Opens each recording and loads each parameter file once, to throw InputError for an unusable one
/// before the work.
void check_recordings(const std::vector<std::string>& sources, const ComparisonPlan& plan);

/// Runs each recording through all estimators of `plan`, on all cores; the result does not depend
/// on their number. Fewer reports if it was stopped. Problems are InputErrors.
std::vector<RecordingReport> compare_recordings(const std::vector<std::string>& sources,
                                                const ComparisonPlan& plan,
                                                const ComparisonControl& control);

}  // namespace condyle::host
