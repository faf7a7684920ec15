// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands/commands.h"
#include "condyle/hal/clock.h"
#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "options/reading_options.h"
#include "options/session_options.h"
#include "output/output_file.h"
#include "output/progress.h"
#include "output/report_text.h"
#include "report/report_page.h"

namespace condyle::host {
namespace {

struct ReportOptions : ReadingOptions {
  std::vector<std::string> recordings, sessions;
  FollowedChoice followed;
  DriveStatement drive;
  std::string drive_file;
  std::string out = "report.html";
};

std::vector<SessionFiles> choose_sessions(const ReportOptions& options) {
  if (options.sessions.empty()) {
    if (!options.recordings.empty()) return {};
    throw InputError("report", "has no recording",
                     "name recordings, or sessions with --session NAME=A.csv,B.csv");
  }
  if (!options.recordings.empty()) {
    throw InputError("--session", "cannot be combined with recordings outside a session",
                     "put each recording into its session");
  }
  return parse_sessions(options.sessions);
}

// The recordings and why some of them could not be read.
struct Sections {
  std::vector<ReportSection> sections;
  std::vector<std::string> problems;
};

// Of several recordings, those that can be read; all of `must_have_all`.
Sections read_sections(const std::vector<std::string>& recordings, const ReportChoice& choice,
                       bool must_have_all, const std::function<void(double)>& progress) {
  Sections read;
  const auto count = static_cast<double>(recordings.size());
  for (std::size_t i = 0; i < recordings.size() && !stop_requested(); ++i) {
    try {
      read.sections.push_back(report_section(
          recordings[i], choice,
          [&](double share) { progress((static_cast<double>(i) + share) / count); },
          stop_requested));
    } catch (const InputError& error) {
      if (recordings.size() == 1 || must_have_all) throw;
      read.problems.push_back(error.what());
    }
  }
  return read;
}

// As `condyle compare` with these sessions; null if it was stopped.
std::unique_ptr<SessionOverlay> compare(const std::vector<SessionFiles>& sessions,
                                        const ReportChoice& choice,
                                        const std::vector<ReportSection>& sections) {
  ComparisonPlan plan;
  plan.estimators.push_back(parse_estimator("recommended", 0));
  plan.choice = {choice.followed, choice.analysis.reading};
  plan.choice.reading.faults = FaultPolicy::event;
  plan.drive = choice.drive;
  auto reports =
      compare_recordings(recordings_of(sessions), plan, {{}, [] { return stop_requested(); }});
  if (stop_requested()) return nullptr;
  return std::make_unique<SessionOverlay>(
      overlay_of(sessions_of(sessions, std::move(reports)), sections));
}

int write_report(const ReportOptions& options) {
  const std::vector<SessionFiles> sessions = choose_sessions(options);
  const std::vector<std::string> recordings =
      sessions.empty() ? options.recordings : recordings_of(sessions);
  const ReportChoice choice{options.choice(), options.followed, options.drive, options.drive_file,
                            options.tasks_file};
  if (!options.drive_file.empty() && recordings.size() > 1) {
    throw InputError("--drive", "belongs to one recording",
                     "report that recording alone, or give each a column drive_N");
  }
  refuse_repeated_recordings(recordings);
  std::vector<std::string> inputs = recordings;
  inputs.insert(inputs.end(), {options.landmarks, options.tasks_file, options.drive_file,
                               choice.analysis.reading.profile});
  refuse_same_files(inputs, {options.out});
  OutputFile file(options.out);
  hal::SteadyClock clock;
  Sections read;
  std::unique_ptr<SessionOverlay> overlay;
  {
    Progress progress("reading", clock);
    read = read_sections(recordings, choice, !sessions.empty(),
                         [&](double share) { progress.show(share); });
    if (!sessions.empty() && !stop_requested()) {
      overlay = compare(sessions, choice, read.sections);
    }
  }
  if (stop_requested()) return report_stop();
  if (!read.sections.empty()) {
    file.write(report_page(read.sections, options.landmarks, overlay.get()));
    file.close();
    file.commit();
    ReportText text(12);
    for (const ReportSection& section : read.sections) text.line("recording", section.recording);
    text.line("report", options.out);
    print_output(text.text());
  }
  for (const std::string& problem : read.problems) print_error(problem);
  return read.problems.empty() ? kExitOk : kExitBadInput;
}

}  // namespace

Command add_report(CommandLine app) {
  auto options = std::make_shared<ReportOptions>();
  const CommandLine command = app.add_command(
      "report", "Write readings, charts and the moving jaw as one HTML page", "Analyse recordings");
  command.add_example(
      "condyle report session.csv --landmarks session.landmarks.toml --out report.html",
      "Write a page that any browser opens, without a network.");
  command.add_example(
      "condyle report --session before=a.csv,b.csv,c.csv --session after=d.csv,e.csv,f.csv",
      "Lay two sessions over each other, with the smallest detectable change.");
  command.add_option("RECORDING", options->recordings,
                     "Three points, poses or one point, in any format that replay reads; one or "
                     "more, or none with --session");
  command
      .add_option("--session", options->sessions,
                  "NAME=A.csv,B.csv,C.csv: a session and its repeat recordings; may be given "
                  "several times")
      .one_value_each();
  add_readings_options(command, *options);
  add_followed_options(command, options->followed, JawPoints::no);
  command.add_option("--drive=FILE", options->drive_file,
                     "Total force along the followed axis, in its own file: CSV with time_s and "
                     "drive_N, or a session log");
  add_drive_options(command, options->drive);
  command.group("Output")
      .add_option("-o,--out=FILE", options->out, "HTML file for the report")
      .show_default();
  return [options] { return write_report(*options); };
}

}  // namespace condyle::host
