// SPDX-License-Identifier: Apache-2.0
#include "study/study_tables.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "recordings/recording_formats.h"
#include "study/participant_level.h"

namespace condyle::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAnalyseAgain = "run the participant level again";

// Columns of readings.csv after the recording's name.
enum Column : std::size_t { kTask, kSide, kStroke, kReading, kValue, kLow, kHigh, kUnit };

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double number_or_nan(std::string_view text) {
  double number = 0;
  return parse_number(text, number) == NumberStatus::ok ? number
                                                        : std::numeric_limits<double>::quiet_NaN();
}

// Why a recording has no readings; empty if it has.
std::string problem_of(const fs::path& folder) {
  std::ifstream file(folder / kProvenanceFile);
  if (!file) return "not analysed yet; run the participant level";
  const nlohmann::json provenance = nlohmann::json::parse(file, nullptr, false);
  if (!provenance.is_object() || provenance.value("format", "") != kStudyFormat) {
    return fmt::format("{} is damaged; delete the recording's folder and run the participant level",
                       kProvenanceFile);
  }
  return provenance.value("problem", "");
}

void read_rows(const fs::path& folder, StudyOutcome& outcome, StudyTables& tables,
               const std::function<void(const StudyRecording&, std::string_view)>& take_row) {
  const StudyRecording& recording = outcome.recording;
  const std::string path = (folder / kReadingsFile).string();
  std::ifstream file(path);
  std::string row;
  if (!std::getline(file, row)) throw InputError(path, "cannot be read", kAnalyseAgain);
  const std::string name = csv_field(recording.recording) + ",";
  std::vector<std::string_view> fields;
  while (std::getline(file, row)) {
    if (!std::string_view(row).starts_with(name)) {
      throw InputError(path, "holds another recording", kAnalyseAgain);
    }
    take_row(recording, row);
    split_row(std::string_view(row).substr(name.size()), fields);
    if (fields.size() <= kUnit) throw InputError(path, "is damaged", kAnalyseAgain);
    if (!fields[kStroke].empty()) continue;
    double value = 0;
    if (parse_number(fields[kValue], value) != NumberStatus::ok) {
      ++outcome.withheld;
      continue;
    }
    ++outcome.shown;
    StudyReading& reading =
        tables.readings[{recording.task, std::string(fields[kTask]), std::string(fields[kSide]),
                         std::string(fields[kReading])}];
    reading.unit = fields[kUnit];
    reading.values.push_back({static_cast<std::uint32_t>(tables.outcomes.size()), value,
                              number_or_nan(fields[kLow]), number_or_nan(fields[kHigh])});
  }
}

void find_scatter(const StudyTables& tables, StudyReading& reading) {
  std::vector<std::vector<double>> sessions, subjects;
  std::string_view subject;
  for (StudySession& session : sessions_of(tables, reading)) {
    if (subjects.empty() || session.subject != subject) subjects.emplace_back();
    subject = session.subject;
    subjects.back().push_back(session.mean);
    sessions.push_back(std::move(session.values));
  }
  reading.subjects = subjects.size();
  reading.repeats = repeatability(sessions);
  reading.retests = repeatability(subjects);
}

}  // namespace

StudyTables gather_study(
    const std::string& out, const std::vector<StudyRecording>& recordings,
    const std::function<void(const StudyRecording&, std::string_view)>& take_row) {
  StudyTables tables;
  for (const StudyRecording& recording : recordings) {
    const fs::path folder = fs::path(out) / recording.folder;
    StudyOutcome outcome{recording, problem_of(folder)};
    if (outcome.problem.empty()) read_rows(folder, outcome, tables, take_row);
    tables.outcomes.push_back(std::move(outcome));
  }
  for (auto& [key, reading] : tables.readings) find_scatter(tables, reading);
  return tables;
}

std::vector<StudySession> sessions_of(const StudyTables& tables, const StudyReading& reading) {
  std::vector<StudySession> sessions;
  for (const StudyValue& value : reading.values) {
    const StudyRecording& recording = tables.outcomes[value.outcome].recording;
    if (sessions.empty() || sessions.back().subject != recording.subject ||
        sessions.back().session != recording.session) {
      sessions.push_back({recording.subject, recording.session, {}});
    }
    StudySession& session = sessions.back();
    session.values.push_back(value.value);
    const double share = 1 / static_cast<double>(session.values.size());
    session.low += share * (value.low - session.low);
    session.high += share * (value.high - session.high);
  }
  for (StudySession& session : sessions) session.mean = mean_of(session.values);
  return sessions;
}

std::vector<StudyChange> changes_of(const StudyTables& tables, const StudyReading& reading) {
  std::vector<StudyChange> changes;
  const std::vector<StudySession> sessions = sessions_of(tables, reading);
  for (auto from = sessions.begin(); from != sessions.end(); ++from) {
    for (auto to = std::next(from); to != sessions.end() && to->subject == from->subject; ++to) {
      const std::size_t n_1 = from->values.size(), n_2 = to->values.size();
      changes.push_back({from->subject, from->session, to->session, from->mean, to->mean, n_1, n_2,
                         reading.repeats.smallest_change(n_1, n_2)});
    }
  }
  return changes;
}

}  // namespace condyle::host
