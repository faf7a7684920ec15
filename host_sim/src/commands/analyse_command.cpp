// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands/commands.h"
#include "condyle/hal/clock.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "options/command_line.h"
#include "options/reading_options.h"
#include "output/deferred_problem.h"
#include "output/gnuplot.h"
#include "output/progress.h"
#include "output/report_text.h"
#include "readings/readings_files.h"
#include "recordings/recording_files.h"

namespace condyle::host {
namespace {

struct AnalyseOptions : ReadingOptions {
  std::vector<std::string> recordings;
  std::string out;
  bool as_json = false;
  bool without_figures = false;
};

// Where the n-th of several recordings has its own files.
std::string prefix_of(std::size_t n, std::size_t count) {
  return count > 1 ? fmt::format("{}_", n + 1) : std::string();
}

int analyse_all(const AnalyseOptions& options) {
  const AnalysisChoice choice = options.choice();
  refuse_repeated_recordings(options.recordings);
  std::unique_ptr<OutputFolder> folder;
  std::vector<std::unique_ptr<OutputFile>> files;
  const auto path_in = [&options](const std::string& name) {
    return (std::filesystem::path(options.out) / name).string();
  };
  const auto write = [&](const std::string& name, const std::string& text) {
    files.push_back(std::make_unique<OutputFile>(path_in(name)));
    files.back()->write(text);
    files.back()->close();
  };
  if (!options.out.empty()) {
    std::vector<std::string> inputs = options.recordings;
    inputs.insert(inputs.end(), {options.landmarks, options.tasks_file});
    for (const char* name : {"readings.csv", "readings.json", "cycles.csv", "average_cycle.csv",
                             "poses.csv", "summary.txt"}) {
      refuse_same_files(inputs, {path_in(name)});
    }
  }
  if (!options.out.empty()) folder = std::make_unique<OutputFolder>(options.out);

  hal::SteadyClock clock;
  std::vector<Analysis> analyses;
  std::vector<std::string> problems;
  const std::string no_figures = why_no_figures();
  const bool draws_figures = folder && !options.without_figures && no_figures.empty();
  std::string text;
  {
    Progress progress("analysing", clock, 1);
    for (std::size_t i = 0; i < options.recordings.size(); ++i) {
      if (stop_requested()) return report_stop();
      progress.show(static_cast<double>(i) / static_cast<double>(options.recordings.size()));
      try {
        Analysis analysis = analyse(options.recordings[i], choice);
        const std::string prefix = prefix_of(i, options.recordings.size());
        if (folder) {
          files.push_back(std::make_unique<OutputFile>(path_in(prefix + "poses.csv")));
          write_poses(analysis, *files.back());
          files.back()->close();
          if (draws_figures) {
            for (auto& figure : draw_readings(options.out, prefix, analysis)) {
              files.push_back(std::move(figure));
            }
          }
        }
        text += (text.empty() ? "" : "\n") + analysis_text(analysis);
        analysis.path = {};
        analyses.push_back(std::move(analysis));
      } catch (const InputError& error) {
        if (options.recordings.size() == 1) throw;
        problems.push_back(error.what());
      }
    }
  }
  if (folder && !options.without_figures && !no_figures.empty()) text += "\n" + no_figures + "\n";
  if (folder) {
    write("readings.csv", readings_csv(analyses));
    write("readings.json", readings_json(analyses));
    write("cycles.csv", cycles_csv(analyses));
    write("average_cycle.csv", average_cycle_csv(analyses));
    write("summary.txt", banner() + text);
  }
  const std::string names = files.empty() ? std::string() : commit_all(files);
  if (options.as_json) {
    print_output(readings_json(analyses));
  } else {
    print_output(banner() + text + (names.empty() ? "" : "\nfiles\n" + names));
  }
  for (const std::string& problem : problems) print_error(problem);
  return problems.empty() ? kExitOk : kExitBadInput;
}

}  // namespace

Command add_analyse(CommandLine app) {
  auto options = std::make_shared<AnalyseOptions>();
  const CommandLine command = app.add_command(
      "analyse", "Read range of motion, condylar paths, chewing and smoothness from recordings",
      "Analyse recordings");
  command.also_called("analyze");
  command.add_example(
      "condyle analyse session.csv --landmarks session.landmarks.toml --out readings",
      "Find the tasks and read everything that the recording shows.");
  command.add_example(
      "condyle analyse session.csv --landmarks session.landmarks.toml --tasks session.tasks.csv",
      "Use the tasks that a file states.");
  command
      .add_option("RECORDING", options->recordings,
                  "Three points, poses or one point, in any format that replay reads; one or more")
      .required();
  add_readings_options(command, *options);
  command.group("Output").add_option("-o,--out=FOLDER", options->out,
                                     "Folder for readings, cycles, poses and figures");
  command.group("Output").add_flag("--no-figures", options->without_figures, "Draw no figures");
  command.group("Output").add_flag("--json", options->as_json,
                                   "Print the readings as JSON, for programs");
  return [options] { return analyse_all(*options); };
}

}  // namespace condyle::host
