// SPDX-License-Identifier: Apache-2.0
// The recordings of a study, from a table or from a Motion-BIDS data set.
//
// Table: CSV with the columns recording, subject, session, task and, if wanted, landmarks and
// tasks; paths are relative to the data set. Without a column, NAME.landmarks.toml and
// NAME.tasks.csv beside the recording NAME.csv are used if they exist.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace condyle::host {

/// The name of the table in a data set that has one.
inline constexpr const char* kStudyTable = "recordings.csv";

/// One recording; paths are relative to the data set.
struct StudyRecording {
  std::string recording, subject, session, task;
  std::string landmarks, tasks;  ///< empty: none
  /// Its folder in the output: sub-SUBJECT/ses-SESSION/NAME, without the part of a missing session.
  std::string folder;
};

/// The recordings in the order of subject, session and name. `table`: file of the table; empty:
/// kStudyTable in `dataset` if it exists, otherwise the files *_motion.tsv of Motion-BIDS. Throws
/// InputError.
std::vector<StudyRecording> read_study(const std::string& dataset, const std::string& table);

/// Those of the `subjects`, with or without "sub-" before each name; all if none is named. Throws
/// InputError for a subject that has no recording.
std::vector<StudyRecording> of_subjects(std::vector<StudyRecording> recordings,
                                        const std::vector<std::string>& subjects);

/// One of `count` parts of a list, `number` from 1: every count-th item.
struct StudyShard {
  std::uint64_t number = 1, count = 1;
  bool has(std::size_t index) const { return index % count == number - 1; }
};

}  // namespace condyle::host
