// SPDX-License-Identifier: Apache-2.0
// The tables of a study's group level.
//
//   repeats   recordings of one subject, session and task: their scatter is within the session
//   retests   sessions of one subject and task: the scatter of their means includes that of the
//             day and of mounting the instrument anew
// Both as in comparison/session_comparison.h, pooled over subjects.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "comparison/session_comparison.h"
#include "study/study_plan.h"

namespace condyle::host {

/// How a recording of the study ended.
struct StudyOutcome {
  StudyRecording recording;
  std::string problem;                  ///< empty: analysed
  std::size_t shown = 0, withheld = 0;  ///< readings of a task
};

/// A reading of a task of the study: the task as the study calls it, the task of the reading, side
/// and name.
using ReadingKey = std::tuple<std::string, std::string, std::string, std::string>;

/// The 95 % interval of a session: means of those of its recordings, as if their errors were the
/// same. NaN: a recording has none.
struct SessionInterval {
  double low = 0, high = 0;
};

/// All values of one reading.
struct StudyReading {
  std::string unit;
  /// By subject and session, in their order: the means of recordings that show it.
  std::map<std::string, std::map<std::string, std::vector<double>>> values;
  std::map<std::string, std::map<std::string, SessionInterval>> intervals;
  Repeatability repeats, retests;
};

/// A change of one subject from one session to a later one.
struct StudyChange {
  std::string subject, from, to;
  double mean_from = 0, mean_to = 0;
  std::size_t count_from = 0, count_to = 0;
  /// Smallest detectable change by the scatter of repeats; NaN: not known.
  double smallest = std::numeric_limits<double>::quiet_NaN();
};

/// Everything that the group level gathers.
struct StudyTables {
  std::vector<StudyOutcome> outcomes;
  std::map<ReadingKey, StudyReading> readings;
};

/// Reads the results of `recordings` in the folder `out`. `take_row` receives each row of their
/// readings.csv.
StudyTables gather_study(
    const std::string& out, const std::vector<StudyRecording>& recordings,
    const std::function<void(const StudyRecording&, std::string_view row)>& take_row);

/// The changes of all subjects in a reading.
std::vector<StudyChange> changes_of(const StudyReading& reading);

}  // namespace condyle::host
