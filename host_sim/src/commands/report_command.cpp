// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands/commands.h"
#include "condyle/hal/clock.h"
#include "hosted/files/input_error.h"
#include "options/command_line.h"
#include "options/reading_options.h"
#include "output/output_file.h"
#include "output/progress.h"
#include "output/report_text.h"
#include "report/report_page.h"

namespace condyle::host {
namespace {

struct ReportOptions : ReadingOptions {
  std::vector<std::string> recordings;
  std::string out = "report.html";
};

int write_report(const ReportOptions& options) {
  const AnalysisChoice choice = options.choice();
  refuse_repeated_recordings(options.recordings);
  std::vector<std::string> inputs = options.recordings;
  inputs.insert(inputs.end(), {options.landmarks, options.tasks_file});
  refuse_same_files(inputs, {options.out});
  OutputFile file(options.out);
  hal::SteadyClock clock;
  std::vector<ReportSection> sections;
  std::vector<std::string> problems;
  {
    Progress progress("reading", clock);
    const auto count = static_cast<double>(options.recordings.size());
    for (std::size_t i = 0; i < options.recordings.size(); ++i) {
      try {
        sections.push_back(report_section(
            options.recordings[i], choice,
            [&](double share) { progress.show((static_cast<double>(i) + share) / count); },
            stop_requested));
      } catch (const InputError& error) {
        if (options.recordings.size() == 1) throw;
        problems.push_back(error.what());
      }
      if (stop_requested()) return report_stop();
    }
  }
  if (!sections.empty()) {
    file.write(report_page(sections, options.landmarks));
    file.close();
    file.commit();
    std::string text = banner();
    for (const ReportSection& section : sections) {
      text += fmt::format("{:<12}{}\n", "recording", clean_line(section.recording));
    }
    print_output(text + fmt::format("{:<12}{}\n", "report", options.out));
  }
  for (const std::string& problem : problems) print_error(problem);
  return problems.empty() ? kExitOk : kExitBadInput;
}

}  // namespace

Command add_report(CommandLine app) {
  auto options = std::make_shared<ReportOptions>();
  const CommandLine command = app.add_command(
      "report", "Write readings, charts and the moving jaw as one HTML page", "Analyse recordings");
  command.add_example(
      "condyle report session.csv --landmarks session.landmarks.toml --out report.html",
      "Write a page that any browser opens, without a network.");
  command.add_example("condyle report session.csv --task opening 5 20",
                      "State what the subject did when.");
  command
      .add_option("RECORDING", options->recordings,
                  "Three points, poses or one point, in any format that replay reads; one or more")
      .required();
  add_readings_options(command, *options);
  command.group("Output")
      .add_option("-o,--out=FILE", options->out, "HTML file for the report")
      .show_default();
  return [options] { return write_report(*options); };
}

}  // namespace condyle::host
