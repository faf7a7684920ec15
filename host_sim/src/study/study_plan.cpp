// SPDX-License-Identifier: Apache-2.0
#include "study/study_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "hosted/files/byte_reader.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "recordings/bids_names.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

namespace fs = std::filesystem;

std::string without_extension(const std::string& path) {
  return fs::path(path).replace_extension().string();
}

std::string if_exists(const fs::path& dataset, const std::string& path) {
  std::error_code failure;
  return fs::is_regular_file(dataset / path, failure) ? path : std::string();
}

// What stands beside a recording.
void find_companions(const fs::path& dataset, StudyRecording& recording) {
  const std::string stem = without_extension(recording.recording);
  if (recording.landmarks.empty()) {
    recording.landmarks = if_exists(dataset, stem + ".landmarks.toml");
  }
  if (recording.tasks.empty()) recording.tasks = if_exists(dataset, stem + ".tasks.csv");
}

enum Column : std::size_t { kRecording, kSubject, kSession, kTask, kLandmarks, kTasks };
constexpr std::array<const char*, 6> kColumns = {"recording", "subject",   "session",
                                                 "task",      "landmarks", "tasks"};

std::vector<StudyRecording> read_table(const fs::path& dataset, const std::string& table) {
  ByteReader reader(table);
  RowReader rows(reader);
  std::string_view row;
  std::vector<std::string_view> fields;
  std::array<std::size_t, kColumns.size()> column_of;
  column_of.fill(std::string::npos);
  const auto place = [&] { return fmt::format("{}:{}", table, rows.line()); };
  if (!rows.next(row)) row = {};
  split_row(row, fields);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t k = 0; k < kColumns.size(); ++k) {
      if (trim(fields[i]) == kColumns[k]) column_of[k] = i;
    }
  }
  for (const Column needed : {kRecording, kSubject, kSession, kTask}) {
    if (column_of[needed] == std::string::npos) {
      throw InputError(place(), fmt::format("there is no column {}", kColumns[needed]),
                       "the first line names the columns: recording,subject,session,task");
    }
  }
  std::vector<StudyRecording> recordings;
  while (rows.next(row)) {
    if (trim(row).empty()) continue;
    split_row(row, fields);
    const auto field = [&](Column column) {
      const std::size_t at = column_of[column];
      return at < fields.size() ? std::string(trim(fields[at])) : std::string();
    };
    StudyRecording recording{field(kRecording),
                             field(kSubject),
                             field(kSession),
                             field(kTask),
                             field(kLandmarks),
                             field(kTasks),
                             {}};
    if (recording.recording.empty()) {
      throw InputError(place(), "the row names no recording", "complete or remove the row");
    }
    if (fs::path(recording.recording).is_absolute()) {
      throw InputError(place(), quote(recording.recording) + " is not relative to the data set",
                       "give the path from the data set's folder");
    }
    check_bids_label(place(), "subject", recording.subject);
    if (!recording.session.empty()) check_bids_label(place(), "session", recording.session);
    if (!recording.task.empty()) check_bids_label(place(), "task", recording.task);
    find_companions(dataset, recording);
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

std::vector<StudyRecording> read_bids(const fs::path& dataset) {
  std::vector<StudyRecording> recordings;
  std::error_code failure;
  auto entries = fs::recursive_directory_iterator(dataset, failure);
  if (failure) {
    throw InputError(dataset.string(), "cannot be read as a folder", "name the data set's folder");
  }
  for (; entries != fs::end(entries); entries.increment(failure)) {
    const std::string name = entries->path().filename().string();
    const fs::path relative = entries->path().lexically_relative(dataset);
    const std::string first = relative.begin()->string();
    if (first == "derivatives" || first == "sourcedata" || first == "code") {
      entries.disable_recursion_pending();
      continue;
    }
    if (!name.ends_with("_motion.tsv") || !name.starts_with("sub-")) continue;
    StudyRecording recording;
    recording.recording = relative.generic_string();
    const BidsLabels labels = bids_labels_in(name);
    recording.subject = labels.subject;
    recording.session = labels.session;
    recording.task = labels.task;
    check_bids_label(recording.recording, "subject", recording.subject);
    find_companions(dataset, recording);
    recordings.push_back(std::move(recording));
  }
  if (failure) {
    throw InputError(dataset.string(), "has a folder that cannot be read: " + failure.message(),
                     "check the permissions of its folders");
  }
  return recordings;
}

// Folders of their own: by name, or where two share a name, by path.
void name_folders(std::vector<StudyRecording>& recordings) {
  const auto folder_of = [](const StudyRecording& recording, std::string name) {
    std::replace_if(
        name.begin(), name.end(),
        [](char c) { return c == '/' || static_cast<unsigned char>(c) < ' '; }, '_');
    const std::string session = recording.session.empty() ? "" : "ses-" + recording.session + "/";
    return "sub-" + recording.subject + "/" + session + name;
  };
  std::map<std::string, int> count;
  for (StudyRecording& recording : recordings) {
    recording.folder =
        folder_of(recording, fs::path(without_extension(recording.recording)).filename().string());
    ++count[recording.folder];
  }
  for (StudyRecording& recording : recordings) {
    if (count[recording.folder] > 1) {
      recording.folder = folder_of(recording, recording.recording);
    }
  }
}

}  // namespace

std::vector<StudyRecording> read_study(const std::string& dataset, const std::string& table) {
  const fs::path folder(dataset);
  const std::string own_table =
      if_exists(folder, kStudyTable).empty() ? "" : (folder / kStudyTable).string();
  const std::string used = table.empty() ? own_table : table;
  std::vector<StudyRecording> recordings =
      used.empty() ? read_bids(folder) : read_table(folder, used);
  if (recordings.empty()) {
    throw InputError(used.empty() ? dataset : used, "names no recording",
                     "add recordings.csv with recording,subject,session,task to the data set, or "
                     "recordings of Motion-BIDS (*_motion.tsv)");
  }
  std::sort(recordings.begin(), recordings.end(),
            [](const StudyRecording& a, const StudyRecording& b) {
              return std::tie(a.subject, a.session, a.recording) <
                     std::tie(b.subject, b.session, b.recording);
            });
  std::set<std::string> seen;
  for (const StudyRecording& recording : recordings) {
    if (!seen.insert(recording.recording).second) {
      throw InputError(used, quote(recording.recording) + " is named twice", "remove one row");
    }
  }
  name_folders(recordings);
  return recordings;
}

std::vector<StudyRecording> of_subjects(std::vector<StudyRecording> recordings,
                                        const std::vector<std::string>& subjects) {
  if (subjects.empty()) return recordings;
  std::set<std::string> wanted;
  for (const std::string& subject : subjects) {
    wanted.insert(subject.starts_with("sub-") ? subject.substr(4) : subject);
  }
  for (const std::string& subject : wanted) {
    const bool is_there =
        std::any_of(recordings.begin(), recordings.end(),
                    [&](const StudyRecording& recording) { return recording.subject == subject; });
    if (!is_there) {
      throw InputError("--participant-label " + quote(subject), "has no recording",
                       "give subjects of the data set");
    }
  }
  std::erase_if(recordings, [&](const StudyRecording& recording) {
    return wanted.count(recording.subject) == 0;
  });
  return recordings;
}

}  // namespace condyle::host
