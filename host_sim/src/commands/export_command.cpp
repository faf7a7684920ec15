// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands/commands.h"
#include "condyle/hal/clock.h"
#include "exports/even_times.h"
#include "exports/export_estimates.h"
#include "exports/export_format.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/table_options.h"
#include "output/progress.h"
#include "output/report_text.h"

namespace condyle::host {
namespace {

struct ExportCommandOptions {
  std::string recording, out, format;
  RecordingChoice reading;
  TableForm form;
  BidsLabels labels;
};

std::string summary(const ExportData& data, const ExportFormat& format,
                    const std::vector<std::string>& notes) {
  constexpr int kLabelWidth = 12;
  ReportText text(kLabelWidth);
  text.line("recording", data.source);
  text.line("read as", data.info.format);
  text.line("written as", fmt::format("{}: {}", format.name, format.meaning));
  text.line("samples", fmt::format("{}, {:.6g} to {:.6g} s", data.samples(),
                                   seconds(data.time_ns.front()), seconds(data.time_ns.back())));
  for (const ExportSeries& series : data.series) {
    std::size_t there = 0;
    for (std::size_t k = 0; k < data.samples(); ++k) there += series.is_there(k) ? 1U : 0U;
    text.line("", fmt::format("{} ({}): {} {}, {} missing", series.name, series.quantity, there,
                              provenance_name(series.provenance), data.samples() - there));
  }
  for (const std::string& note : notes) text.line("note", note);
  return text.text();
}

// Beside the measurements, where there is one point to follow.
void add_estimates(const ExportCommandOptions& options, ExportData& data) {
  try {
    data.estimates = std::make_shared<ExportEstimates>(options.recording, options.reading,
                                                       options.form.resample_Hz, stop_requested);
  } catch (const InputError& error) {
    data.notes.push_back(fmt::format("no estimates: {}", error.what()));
  }
}

int run(const ExportCommandOptions& options) {
  const ExportFormat& format = export_format(options.format, options.out);
  if (options.form.has_decimal_comma && !format.takes_decimal_comma) {
    throw InputError("--decimal-comma", fmt::format("does not apply to {}", format.name),
                     "leave it out, or write CSV");
  }
  const BidsLabels& labels = options.labels;
  if (!format.takes_labels &&
      !(labels.subject + labels.session + labels.task + labels.run).empty()) {
    throw InputError("--subject, --session, --task or --run",
                     fmt::format("does not apply to {}", format.name),
                     "leave it out, or give --format bids");
  }
  refuse_same_files({options.recording}, {options.out});
  hal::SteadyClock clock;
  ExportData data;
  {
    Progress progress("reading", clock);
    data = read_export_data(options.recording, options.reading.reading, [&](double share) {
      progress.show(share);
      return stop_requested();
    });
  }
  if (stop_requested()) return report_stop();
  data.labels = labels;
  if (options.form.resample_Hz) resample(data, *options.form.resample_Hz);
  if (format.takes_estimates) add_estimates(options, data);
  Exported written = format.write(data, options.form, options.out);
  if (stop_requested()) return report_stop();
  std::vector<std::string> notes = data.info.notes;
  notes.insert(notes.end(), data.notes.begin(), data.notes.end());
  notes.insert(notes.end(), written.notes.begin(), written.notes.end());
  const std::string names = commit_all(written.files);
  print_output(summary(data, format, notes) + "\nfiles\n" + names);
  return kExitOk;
}

}  // namespace

Command add_export(CommandLine app) {
  auto options = std::make_shared<ExportCommandOptions>();
  const CommandLine command = app.add_command(
      "export", "Write a recording as C3D, TRC, CSV or another format, for other programs",
      "Analyse recordings");
  command.add_example("condyle export session.csv --out session.c3d",
                      "Write all points, for programs of motion capture.");
  command.add_example("condyle export session.csv --out session.trc --resample-Hz 50",
                      "Write them for OpenSim, at 50 samples per second.");
  command.add_option("RECORDING", options->recording, "As for replay; all points are taken")
      .required();
  command.add_example(
      "condyle export session.csv --out shared --format bids --subject 01 --task clinical",
      "Add it to a data set of Motion-BIDS.");
  const CommandLine output = command.group("Output");
  const Option out =
      output
          .add_option("-o,--out=FILE", options->out,
                      "The file, whose ending chooses the format; of bids the folder")
          .required();
  std::string formats;
  for (const ExportFormat& format : export_formats()) {
    formats += (formats.empty() ? "" : ", ") + std::string(format.name);
  }
  output.add_option("--format", options->format,
                    "One of " + formats + ", if the ending of the file does not say");
  const CommandLine names = command.group("Names in BIDS");
  names.add_option("--subject", options->labels.subject,
                   "Letters and digits; without it as in the recording's name, sub-01_task-open");
  names.add_option("--session", options->labels.session, "The same, ses-; may be left out");
  names.add_option("--task", options->labels.task, "The same, task-: what was recorded");
  names.add_option("--run", options->labels.run, "The same, run-: a number; may be left out");
  add_table_options(command, options->form, out, "as is usual for the format");
  add_recording_options(command, options->reading);
  return [options] { return run(*options); };
}

}  // namespace condyle::host
