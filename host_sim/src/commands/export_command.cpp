// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "commands/commands.h"
#include "condyle/hal/clock.h"
#include "exports/computed_series.h"
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
  bool has_estimates = false, has_pose = false;
  LandmarkChoice landmarks;
  std::vector<double> reference_s;
};

// "4215 measured, 15 assumed, 0 missing": a sample counts as its least certain component.
std::string counts_text(const ExportSeries& series, std::size_t samples) {
  std::array<std::size_t, 4> counts{};
  std::size_t missing = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    if (!series.is_there(k)) {
      ++missing;
      continue;
    }
    Provenance least = Provenance::measured;
    for (std::size_t i = 0; i < series.components.size(); ++i) {
      least = std::min(least, series.provenance_at(k, i));
    }
    ++counts[static_cast<std::size_t>(least)];
  }
  std::string text;
  for (const Provenance one : {Provenance::measured, Provenance::derived, Provenance::assumed}) {
    const std::size_t count = counts[static_cast<std::size_t>(one)];
    if (count > 0) text += fmt::format("{} {}, ", count, provenance_name(one));
  }
  return text + fmt::format("{} missing", missing);
}

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
    if (series.is_computed && series.quantity.ends_with("_sd")) continue;
    text.line("", fmt::format("{} ({}): {}", series.name, series.quantity,
                              counts_text(series, data.samples())));
  }
  for (const std::string& note : notes) text.line("note", note);
  return text.text();
}

// Beside the measurements, where there is one point to follow.
void add_estimates(const ExportCommandOptions& options, const ExportFormat& format,
                   ExportData& data) {
  try {
    data.estimates = std::make_shared<ExportEstimates>(options.recording, options.reading,
                                                       options.form.resample_Hz, stop_requested);
  } catch (const InputError& error) {
    if (options.has_estimates) throw;
    data.notes.push_back(fmt::format("no estimates: {}", error.what()));
  }
  if (!format.takes_estimates) add_estimate_series(data);
}

// What is computed from the places, beside them.
void add_pose_and_landmarks(const ExportCommandOptions& options, const ExportFormat& format,
                            ExportData& data) {
  if (format.takes_labels && (options.has_pose || !options.landmarks.file.empty())) {
    throw InputError("--pose or --landmarks", "is given, and a data set holds measurements",
                     "leave it out, or export to another format");
  }
  const bool is_always_written = format.write == export_mcap;
  if (!options.landmarks.file.empty()) {
    LandmarkChoice landmarks = options.landmarks;
    if (options.reference_s.size() == 2) {
      landmarks.reference_s = {options.reference_s[0], options.reference_s[1]};
    }
    add_landmark_series(landmarks, options.reading.reading, data);
  }
  if (options.has_pose && !is_always_written) add_pose_series(data);
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
  add_pose_and_landmarks(options, format, data);
  if (options.form.resample_Hz) resample(data, *options.form.resample_Hz);
  if (format.takes_estimates || options.has_estimates) add_estimates(options, format, data);
  if (stop_requested()) return report_stop();
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
  command.add_example(
      "condyle export session.csv --out session.mat --estimates --point 1 --landmarks "
      "session.landmarks.toml",
      "Write velocity, and the condyles' motion, for MATLAB.");
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
  const CommandLine computed = command.group("What is computed");
  computed.add_flag("--estimates", options->has_estimates,
                    "Also position, velocity, acceleration and net force, as replay estimates them "
                    "(mcap and bids have them always)");
  computed.add_flag("--pose", options->has_pose,
                    "Also the pose of the jaw that three points form (mcap has it always)");
  Option landmarks = computed.add_option(
      "--landmarks=FILE", options->landmarks.file,
      "Also the condylar points and the lower incisor of this TOML file, moving with the jaw");
  computed
      .add_option("--reference-s", options->reference_s,
                  "Begin and end (s) of the reference position of the landmarks; without it found")
      .values(2)
      .needs(landmarks);
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
