// SPDX-License-Identifier: Apache-2.0
#include "study/group_level.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "output/output_file.h"
#include "output/report_text.h"

namespace condyle::host {
namespace {

namespace fs = std::filesystem;

// Nothing for what is not known.
std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string();
}

std::string key_cells(const ReadingKey& key) {
  const auto& [study_task, task, side, name] = key;
  return fmt::format("{},{},{},{}", study_task, task, side, name);
}

std::string repeatability_csv(const StudyTables& tables) {
  std::string text =
      "study_task,task,side,reading,unit,scatter,subjects,recordings,degrees_of_freedom,sd,sd_low,"
      "sd_high,smallest_detectable_change\n";
  for (const auto& [key, reading] : tables.readings) {
    const std::pair<const char*, const Repeatability*> scatters[] = {
        {"within sessions", &reading.repeats}, {"between sessions", &reading.retests}};
    for (const auto& [name, scatter] : scatters) {
      const bool is_known = scatter->is_known();
      text += fmt::format(
          "{},{},{},{},{},{},{},{},{},{}\n", key_cells(key), reading.unit, name, reading.subjects,
          reading.values.size(), scatter->degrees_of_freedom,
          is_known ? number(scatter->within_sd) : "", is_known ? number(scatter->interval.low) : "",
          is_known ? number(scatter->interval.high) : "", number(scatter->smallest_change(1, 1)));
    }
  }
  return text;
}

// Written at once: of many subjects they are the longest table but the readings.
void write_changes(const StudyTables& tables, OutputFile& file) {
  file.write(
      "subject,study_task,task,side,reading,unit,from,to,mean_from,mean_to,recordings_from,"
      "recordings_to,change,smallest_detectable_change\n");
  for (const auto& [key, reading] : tables.readings) {
    const std::string cells = key_cells(key);
    for (const StudyChange& change : changes_of(tables, reading)) {
      file.write(fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", change.subject, cells,
                             reading.unit, change.from, change.to, number(change.mean_from),
                             number(change.mean_to), change.count_from, change.count_to,
                             number(change.mean_to - change.mean_from), number(change.smallest)));
    }
  }
}

std::string problems_csv(const StudyTables& tables) {
  std::string text = "recording,subject,session,task,problem\n";
  for (const StudyOutcome& outcome : tables.outcomes) {
    if (outcome.problem.empty()) continue;
    const StudyRecording& recording = outcome.recording;
    text += fmt::format("{},{},{},{},{}\n", csv_field(recording.recording), recording.subject,
                        recording.session, recording.task, csv_field(outcome.problem));
  }
  return text;
}

}  // namespace

std::string reading_title(const ReadingKey& key) {
  const auto& [study_task, task, side, name] = key;
  std::string title = name;
  if (!side.empty()) title += ", " + side;
  title += " (" + task;
  if (!study_task.empty() && study_task != task) title += " in " + study_task;
  return title + ")";
}

std::string scatter_text(const Repeatability& scatter, const std::string& unit) {
  if (!scatter.is_known()) return {};
  return fmt::format("{:.3g} {} ({:.3g} to {:.3g}); {:.3g} {}", scatter.within_sd, unit,
                     scatter.interval.low, scatter.interval.high, scatter.smallest_change(1, 1),
                     unit);
}

std::string run_group_level(const std::string& out, const std::vector<StudyRecording>& recordings) {
  const fs::path group = fs::path(out) / "group";
  std::error_code failure;
  if (!fs::is_directory(out, failure)) {
    throw InputError(out, "has no results", "run condyle study ... participant first");
  }
  fs::create_directories(group);
  for (const auto& entry : fs::directory_iterator(group)) {
    // Of a run that was killed.
    if (entry.path().filename().string().find(".partial-") != std::string::npos) {
      fs::remove(entry.path(), failure);
    }
  }
  std::vector<std::unique_ptr<OutputFile>> files;
  const auto open = [&](const char* name) -> OutputFile& {
    return *files.emplace_back(std::make_unique<OutputFile>((group / name).string()));
  };
  OutputFile& rows = open("readings.csv");
  rows.write(
      "subject,session,study_task,recording,task,side,stroke,reading,value,low,high,unit,"
      "definition,provenance,reason\n");
  const StudyTables tables =
      gather_study(out, recordings, [&](const StudyRecording& recording, std::string_view row) {
        rows.write(fmt::format("{},{},{},{}\n", recording.subject, recording.session,
                               recording.task, row));
      });
  open("problems.csv").write(problems_csv(tables));
  open("repeatability.csv").write(repeatability_csv(tables));
  write_changes(tables, open("changes.csv"));
  open("study.html").write(study_page(tables));
  for (const auto& file : files) file->close();

  const auto problems =
      std::count_if(tables.outcomes.begin(), tables.outcomes.end(),
                    [](const StudyOutcome& outcome) { return !outcome.problem.empty(); });
  ReportText text(12);
  text.line("recordings", fmt::format("{}, {} with problems", tables.outcomes.size(), problems));
  text.line("readings", fmt::format("{} kinds, by task and side", tables.readings.size()));
  return text.text() + "\nfiles\n" + commit_all(files);
}

}  // namespace condyle::host
