// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "commands/commands.h"
#include "condyle/hal/clock.h"
#include "hosted/files/input_error.h"
#include "options/command_line.h"
#include "options/reading_options.h"
#include "options/shard_option.h"
#include "output/output_file.h"
#include "output/progress.h"
#include "output/report_text.h"
#include "study/group_level.h"
#include "study/participant_level.h"
#include "study/slurm_script.h"
#ifdef CONDYLE_HAS_REPORT
#include "report/report_page.h"
#endif

namespace condyle::host {
namespace {

struct StudyOptions : ReadingOptions {
  std::string dataset, out, level, table, shard, slurm;
  std::vector<std::string> subjects;
  std::uint64_t shards = 0;
  int jobs = 0;
  bool with_poses = false, with_reports = false;
};

#ifdef CONDYLE_HAS_REPORT
void write_report(const std::string& recording, const AnalysisChoice& choice,
                  const std::string& path) {
  ReportChoice report;
  report.analysis = choice;
  const ReportSection section = report_section(
      recording, report, [](double) {}, [] { return false; });
  OutputFile file(path);
  file.write(report_page({section}, choice.landmarks, nullptr));
  file.close();
  file.commit();
}
#endif

StudyChoice study_choice(const StudyOptions& options) {
  StudyChoice choice{options.dataset,    options.out, options.choice(),
                     options.with_poses, nullptr,     static_cast<unsigned>(options.jobs)};
  if (options.with_reports) {
#ifdef CONDYLE_HAS_REPORT
    choice.write_report = write_report;
#else
    throw InputError("--reports", "is not part of this build, which has no report",
                     "install esbuild and npm, and build again");
#endif
  }
  return choice;
}

int run_participants(const StudyOptions& options, const std::vector<StudyRecording>& recordings) {
  const StudyChoice choice = study_choice(options);
  StudyShard shard;
  if (!options.shard.empty()) {
    const auto [number, count] = parse_shard(options.shard);
    shard = {number, count};
  }
  hal::SteadyClock clock;
  StudyCounts counts;
  {
    Progress progress("analysing", clock, 1);
    counts = run_participant_level(
        choice, recordings, shard, [&](double share) { progress.show(share); }, stop_requested);
  }
  if (stop_requested()) {
    print_error("stopped; the same command goes on where it stopped");
    return kExitInterrupted;
  }
  ReportText text(12);
  text.line("recordings", fmt::format("{} analysed, {} unchanged since an earlier run",
                                      counts.analysed + counts.problems, counts.unchanged));
  if (counts.problems > 0) {
    text.line("problems", fmt::format("{}; the group level lists them", counts.problems));
  }
  text.line("next", fmt::format("condyle study {} {} group", options.dataset, options.out));
  print_output(text.text());
  return kExitOk;
}

// The options of the participant level as they were given.
std::string words_of(const StudyOptions& options) {
  std::string words;
  const auto add = [&words](const char* option, const std::string& value) {
    if (!value.empty()) words += fmt::format("{} {} ", option, shell_word(value));
  };
  add("--table", options.table);
  add("--landmarks", options.landmarks);
  add("--jaw", options.jaw_names);
  add("--head", options.head_names);
  add("--profile", options.reading.profile);
  for (const std::string& column : options.reading.columns) add("--columns", column);
  for (const std::string& marker : options.reading.markers) add("--marker", marker);
  for (const std::string& column : options.reading.ignored_columns) add("--ignore-column", column);
  if (options.reading.rate_Hz) words += fmt::format("--rate-Hz {} ", *options.reading.rate_Hz);
  if (options.reading.units_per_metre) {
    add("--unit", *options.reading.units_per_metre > 1 ? "mm" : "m");
  }
  add("--missing", options.reading.missing.text);
  if (options.reading.movement != 1) {
    words += fmt::format("--movement {} ", options.reading.movement);
  }
  if (options.moving_body != "lower") add("--moving", options.moving_body);
  if (!options.reference.empty()) {
    words += fmt::format("--reference-s {} {} ", options.reference[0], options.reference[1]);
  }
  if (options.with_poses) words += "--poses ";
  if (options.with_reports) words += "--reports ";
  return words;
}

int write_script(const StudyOptions& options, std::size_t recordings) {
  const std::uint64_t shards =
      options.shards > 0 ? options.shards : std::clamp<std::uint64_t>(recordings / 50, 1, 1000);
  OutputFile file(options.slurm);
  file.write(slurm_script(options.dataset, options.out, words_of(options), shards));
  file.close();
  file.commit();
  ReportText text(12);
  text.line("script", options.slurm);
  text.line("shards", fmt::format("{}, of {} recordings", shards, recordings));
  text.line("next", "sbatch " + options.slurm);
  print_output(text.text());
  return kExitOk;
}

int run_study(const StudyOptions& options) {
  if (!options.task_words.empty() || !options.tasks_file.empty()) {
    throw InputError("study", "takes tasks from the files of each recording",
                     "write NAME.tasks.csv beside NAME.csv, or name it in the column tasks");
  }
  const auto recordings = of_subjects(read_study(options.dataset, options.table), options.subjects);
  if (options.level == "group") {
    print_output(run_group_level(options.out, recordings));
    return kExitOk;
  }
  if (!options.slurm.empty()) return write_script(options, recordings.size());
  return run_participants(options, recordings);
}

}  // namespace

Command add_study(CommandLine app) {
  auto options = std::make_shared<StudyOptions>();
  const CommandLine command =
      app.add_command("study", "Analyse all recordings of a data set, on one computer or a cluster",
                      "Analyse recordings");
  command.add_example("condyle study dataset results participant --jobs 2",
                      "Analyse every recording; started again, it does only what is missing.");
  command.add_example("condyle study dataset results group",
                      "Gather the results: tables, repeatability and a page.");
  command
      .add_option("DATASET", options->dataset,
                  "Folder with recordings.csv (recording, subject, session, task) or Motion-BIDS")
      .required();
  command.add_option("OUT", options->out, "Folder for the results").required();
  command.add_option("LEVEL", options->level, "participant, then group")
      .one_of({"participant", "group"})
      .required();
  command.add_option("--participant-label", options->subjects,
                     "Only these subjects, with or without sub-");
  command.add_option("--table=FILE", options->table, "The table, if it is not recordings.csv");
  command.add_option("--jobs", options->jobs, "Recordings at a time; 0: one for each core")
      .within(0, 1024)
      .show_default();
  command.add_option("--shard=I/N", options->shard, "Only the I-th of N parts of the recordings");
  command.add_option("--slurm=FILE", options->slurm,
                     "Write a script for Slurm that runs all shards, and analyse nothing");
  command.add_option("--shards", options->shards,
                     "Jobs of that script; default: one for 50 recordings");
  add_readings_options(command, *options);
  command.group("Output").add_flag("--poses", options->with_poses,
                                   "Write poses.csv of each recording");
  command.group("Output").add_flag("--reports", options->with_reports,
                                   "Write report.html of each recording");
  return [options] { return run_study(*options); };
}

}  // namespace condyle::host
