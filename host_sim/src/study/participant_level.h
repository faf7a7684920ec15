// SPDX-License-Identifier: Apache-2.0
// The participant level of a study: each recording analysed by a process of its own, so that a
// crash or a lack of memory ends one recording only.
//
// A recording's results appear whole in OUT/sub-.../NAME/: they are written in OUT/.work and
// renamed. provenance.json there holds what they rest on; while that stays the same, the recording
// is not analysed again. No file holds a clock time, a computer's name or an absolute path.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "readings/analysis.h"
#include "study/study_plan.h"

namespace condyle::host {

/// Writes a report of a recording; null: this build has none.
using WriteReport = std::function<void(const std::string& recording, const AnalysisChoice& choice,
                                       const std::string& path)>;

/// What to do with each recording.
struct StudyChoice {
  std::string dataset, out;  ///< folders
  AnalysisChoice analysis;   ///< without tasks; its landmarks are used if a recording has none
  bool with_poses = false;
  WriteReport write_report;  ///< null: no reports
  unsigned jobs = 0;         ///< processes at a time; 0: one for each core
};

/// How the recordings of a run ended.
struct StudyCounts {
  std::size_t analysed = 0, unchanged = 0, problems = 0;
};

/// Analyses those of `recordings` that are in `shard`. `progress` receives the share of them that
/// is done, `should_stop` ends the work; what is not finished then is done by the next run.
StudyCounts run_participant_level(const StudyChoice& choice,
                                  const std::vector<StudyRecording>& recordings,
                                  const StudyShard& shard,
                                  const std::function<void(double)>& progress,
                                  const std::function<bool()>& should_stop);

/// Names of the files of a recording.
inline constexpr const char* kProvenanceFile = "provenance.json";
inline constexpr const char* kReadingsFile = "readings.csv";
inline constexpr const char* kStudyFormat = "condyle-study-1";

}  // namespace condyle::host
