// SPDX-License-Identifier: Apache-2.0
// The tables of a study's group level.
//
//   repeats   recordings of one subject, session and task: their scatter is within the session
//   retests   sessions of one subject and task: the scatter of their means includes that of the
//             day and of mounting the instrument anew
// Both as in comparison/session_comparison.h, pooled over subjects.
#pragma once

#include <cstdint>
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

/// A value of one recording, with its 95 % interval. NaN: it has none.
struct StudyValue {
  std::uint32_t outcome;  ///< index in StudyTables::outcomes
  double value, low, high;
};

/// All values of one reading, in the order of the recordings: by subject, then session.
struct StudyReading {
  std::string unit;
  std::vector<StudyValue> values;
  std::size_t subjects = 0;
  Repeatability repeats, retests;
};

/// The recordings of one session of one subject that show a reading. The interval is the mean of
/// theirs, as if their errors were the same. NaN: a recording has none.
struct StudySession {
  std::string_view subject, session;
  std::vector<double> values;
  double mean = 0, low = 0, high = 0;
};

/// A change of one subject from one session to a later one.
struct StudyChange {
  std::string_view subject, from, to;
  double mean_from = 0, mean_to = 0;
  std::size_t count_from = 0, count_to = 0;
  /// Smallest detectable change by the scatter of repeats; NaN: not known.
  double smallest = std::numeric_limits<double>::quiet_NaN();
};

/// Everything that the group level gathers. It is all in memory: 32 bytes for each value.
struct StudyTables {
  std::vector<StudyOutcome> outcomes;
  std::map<ReadingKey, StudyReading> readings;
};

/// Reads the results of `recordings` in the folder `out`. `take_row` receives each row of their
/// readings.csv.
StudyTables gather_study(
    const std::string& out, const std::vector<StudyRecording>& recordings,
    const std::function<void(const StudyRecording&, std::string_view row)>& take_row);

/// A reading by subject and session, in their order.
std::vector<StudySession> sessions_of(const StudyTables& tables, const StudyReading& reading);

/// The changes of all subjects in a reading.
std::vector<StudyChange> changes_of(const StudyTables& tables, const StudyReading& reading);

}  // namespace condyle::host
