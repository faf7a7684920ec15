// SPDX-License-Identifier: Apache-2.0
// Several estimators on the same recordings, or several sessions of one subject.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "commands/commands.h"
#include "comparison/comparison_text.h"
#include "comparison/session_text.h"
#include "condyle/hal/clock.h"
#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "options/session_options.h"
#include "output/progress.h"
#include "output/report_text.h"

namespace condyle::host {
namespace {

struct CompareOptions {
  std::vector<std::string> recordings, estimators, sessions;
  int lag = 0;
  std::string out, figures;
  ComparisonPlan plan;
};

std::vector<NamedEstimator> choose_estimators(const CompareOptions& options) {
  std::vector<std::string> names = options.estimators;
  if (names.empty()) {
    names = options.sessions.empty() ? std::vector<std::string>{"recommended", "published"}
                                     : std::vector<std::string>{"recommended"};
  }
  refuse_repeated_names("--with", names);
  std::vector<NamedEstimator> estimators;
  for (const std::string& name : names) estimators.push_back(parse_estimator(name, options.lag));
  if (std::all_of(estimators.begin(), estimators.end(),
                  [](const NamedEstimator& named) { return named.option.is_published(); })) {
    estimators[0].option.refuse_if_published("--lag", options.lag > 0, "--with");
    estimators[0].option.refuse_if_published("--drive-...", options.plan.drive.is_given(),
                                             "--with");
  }
  return estimators;
}

void refuse_jaw_point_of_published(const ComparisonPlan& plan) {
  if (plan.choice.jaw_point_mm.empty()) return;
  for (const NamedEstimator& named : plan.estimators) {
    if (!named.option.is_published()) continue;
    throw InputError("--jaw-point-mm",
                     "the published cascade follows points of the instrument only",
                     "leave it out, or give --with recommended alone");
  }
}

std::vector<SessionFiles> choose_sessions(const CompareOptions& options) {
  if (options.sessions.empty()) {
    if (!options.recordings.empty()) return {};
    throw InputError("compare", "has nothing to compare",
                     "name recordings, or sessions with --session NAME=A.csv,B.csv");
  }
  if (!options.recordings.empty()) {
    throw InputError("--session", "cannot be combined with recordings outside a session",
                     "put each recording into its session");
  }
  std::vector<SessionFiles> sessions = parse_sessions(options.sessions);
  if (options.estimators.size() > 1) {
    throw InputError("--with", "sessions are compared with one estimator", "give one");
  }
  return sessions;
}

// The text, and the content of the table; adds the figures to `files`.
struct Outcome {
  std::string text, table;
};

Outcome compare_all(const CompareOptions& options, const ComparisonPlan& plan,
                    const std::vector<SessionFiles>& session_files,
                    std::vector<RecordingReport> reports,
                    std::vector<std::unique_ptr<OutputFile>>& figures) {
  if (session_files.empty()) {
    if (!options.figures.empty()) {
      figures = draw_comparison(options.figures, plan.estimators, reports);
    }
    return {comparison_text(plan.estimators, reports), comparison_csv(plan.estimators, reports)};
  }
  const std::vector<Session> sessions = sessions_of(session_files, std::move(reports));
  const SessionComparison comparison = compare_sessions(sessions);
  const std::string& estimator = plan.estimators[0].name;
  if (!options.figures.empty()) {
    figures = draw_sessions(options.figures, estimator, sessions, comparison);
  }
  return {session_text(estimator, sessions, comparison), session_csv(sessions, comparison)};
}

int compare(const CompareOptions& options) {
  const std::vector<SessionFiles> sessions = choose_sessions(options);
  const std::vector<std::string> sources =
      sessions.empty() ? options.recordings : recordings_of(sessions);
  refuse_repeated_recordings(sources);
  ComparisonPlan plan = options.plan;
  plan.estimators = choose_estimators(options);
  refuse_jaw_point_of_published(plan);
  plan.choice.reading.may_lack_ignored = sources.size() > 1;
  std::vector<std::string> inputs = sources;
  inputs.push_back(plan.choice.reading.profile);
  for (const NamedEstimator& estimator : plan.estimators) {
    inputs.push_back(estimator.option.parameters);
  }
  refuse_same_files(inputs, {options.out});
  check_recordings(sources, plan);
  // Opened first, to report an output that cannot be written before the work.
  std::unique_ptr<OutputFolder> folder;
  if (!options.figures.empty()) folder = std::make_unique<OutputFolder>(options.figures);
  std::vector<std::unique_ptr<OutputFile>> files;
  if (!options.out.empty()) files.push_back(std::make_unique<OutputFile>(options.out));

  hal::SteadyClock clock;
  std::vector<RecordingReport> reports;
  {
    Progress progress("comparing", clock, 1);
    reports = compare_recordings(
        sources, plan,
        {[&](double share) { progress.show(share); }, [] { return stop_requested(); }});
  }
  if (stop_requested()) {
    return report_stop();
  }
  std::vector<std::unique_ptr<OutputFile>> figures;
  const Outcome outcome = compare_all(options, plan, sessions, std::move(reports), figures);
  if (!files.empty()) {
    files[0]->write(outcome.table);
    files[0]->close();
  }
  std::string text = banner() + outcome.text;
  for (auto& figure : figures) files.push_back(std::move(figure));
  text += commit_all(files);
  if (folder && figures.empty()) text += "no figure: there are no values to draw\n";
  print_output(text);
  return kExitOk;
}

}  // namespace

Command add_compare(CommandLine app) {
  auto options = std::make_shared<CompareOptions>();
  const CommandLine command =
      app.add_command("compare",
                      "Compare estimators on the same recordings, or sessions of one subject with "
                      "the smallest detectable change",
                      "Analyse recordings");
  command.add_example("condyle compare jaw.csv --with recommended --with published",
                      "Compare how well two estimators predict the next sample.");
  command.add_example(
      "condyle compare --session before=a.csv,b.csv,c.csv --session after=d.csv,e.csv,f.csv",
      "Compare two sessions, with the smallest detectable change.");
  command.add_option("RECORDING", options->recordings, "Recordings, each as for replay");
  command
      .add_option("--with", options->estimators,
                  "An estimator: recommended, published, recommended:FILE.toml or "
                  "published:FILE.toml with its parameters; may be given several times. The first "
                  "is the baseline. Default: both (with --session: recommended only)")
      .one_value_each();
  command
      .add_option("--session", options->sessions,
                  "NAME=A.csv,B.csv,C.csv: a session and its repeat recordings; may be given "
                  "several times")
      .one_value_each();
  command.add_option("--lag", options->lag, "Fixed lag in samples (recommended)")
      .within(0, 16)
      .show_default();
  add_recording_options(command, options->plan.choice);
  add_drive_options(command, options->plan.drive);
  command.group("Output").add_option("-o,--out=FILE", options->out,
                                     "CSV file: one row for each recording and estimator; with "
                                     "--session, for each quantity and pair of sessions");
  command.group("Output").add_option("--figures=FOLDER", options->figures,
                                     "Folder for the figure (SVG and PNG)");
  return [options] { return compare(*options); };
}

}  // namespace condyle::host
