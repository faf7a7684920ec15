// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>

#include "commands/commands.h"
#include "condyle/estimator/sensors/published_sensor.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/firmware/sensor_choice.h"
#include "condyle/firmware/sensor_with_pose.h"
#include "condyle/hal/clock.h"
#include "estimation/replayed_drive.h"
#include "hosted/config/parameter_file.h"
#include "hosted/estimates/estimate_json.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "options/table_options.h"
#include "output/cycles_file.h"
#include "output/deferred_problem.h"
#include "output/device_values.h"
#include "output/estimates_file.h"
#include "output/figures.h"
#include "output/pose_file.h"
#include "output/progress.h"
#include "output/replay_summary.h"
#include "output/report_text.h"
#include "recordings/recording_files.h"
#include "recordings/replay_facebow.h"

namespace condyle::host {
namespace {

struct ReplayOptions : RecordingChoice {
  std::string recording;
  EstimatorChoice estimator;
  LearnedFiles learned;
  std::string out;
  TableForm out_form;
  std::string figures;
  std::string values;
  bool as_json = false;
  double speed = 0;
  std::string drive;  // a recording of its own
  DriveStatement drive_stated;
  PoseOptions pose;
  CycleOptions cycles;
};

// The recording, and what is followed in it.
std::string recording_text(const ReplayOptions& options, const RecordingInfo& info) {
  return fmt::format("{}, {}, {}", options.recording, info.format, options.text(info.kind));
}

std::vector<std::string> pose_warnings(const ReplayOptions& options, const PoseSummary& pose) {
  return options.pose.file.empty() ? std::vector<std::string>() : pose.warnings();
}

std::string summary_json(const ReplayOptions& options, const RecordingInfo& info,
                         const std::vector<std::string>& drive_notes, const ReplaySummary& summary,
                         const PoseSummary& pose, const nlohmann::ordered_json& cycles) {
  nlohmann::ordered_json json = {
      {"format", "condyle-replay-1"},
      {"condyle", CONDYLE_VERSION},
      {"recording", clean_line(options.recording)},
      {"recording_format", clean_line(info.format)},
      {"followed", info.kind == SampleKind::one_axis
                       ? "one axis"
                       : std::string(1, "xyz"[static_cast<int>(options.followed.axis)])},
      {"estimator", options.estimator.name}};
  json.update(summary.json());
  if (!cycles.is_null()) json["cycles"] = cycles;
  nlohmann::ordered_json& notes = json["notes"] = nlohmann::ordered_json::array();
  for (const std::string& note : info.notes) notes.push_back(clean_line(note));
  for (const std::string& note : drive_notes) notes.push_back(clean_line(note));
  json["warnings"] = summary.warnings();
  for (const std::string& warning : pose_warnings(options, pose)) {
    json["warnings"].push_back(warning);
  }
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

// Runs `sensor` over the open `facebow` and writes the requested outputs. `row_of_step(sample,
// estimate)` gives a row, or none while a lag fills; `learned()`, if not empty, what was learned.
template <class Sensor, class RowOfStep>
int replay_through(const ReplayOptions& options, ReplayFacebow& facebow, hal::Clock& clock,
                   const firmware::RunSettings& settings, Sensor& sensor, int axis_count,
                   bool has_impedance, const std::function<std::string()>& learned,
                   const RowOfStep& row_of_step, ReplaySummary& summary) {
  // Opened first, to report an output that cannot be written before the work.
  std::unique_ptr<OutputFolder> figure_folder;
  if (!options.figures.empty()) figure_folder = std::make_unique<OutputFolder>(options.figures);
  std::unique_ptr<EstimatesFile> estimates;
  if (!options.out.empty()) {
    estimates = std::make_unique<EstimatesFile>(options.out, axis_count, has_impedance,
                                                options.out_form, learned != nullptr);
  }
  std::unique_ptr<OutputFile> learned_file;
  if (!options.learned.out.empty()) {
    learned_file = std::make_unique<OutputFile>(options.learned.out);
  }
  std::unique_ptr<PoseFile> poses;
  if (!options.pose.file.empty()) {
    poses = std::make_unique<PoseFile>(options.pose.file, options.pose.choice());
  }
  PoseSummary pose_summary;
  std::unique_ptr<CyclesFile> cycles;
  if (!options.cycles.file.empty()) cycles = std::make_unique<CyclesFile>(options.cycles.file);
  FollowedCycles followed_cycles(options.cycles.choice(options.followed.axis));
  CyclesSummary cycles_summary;
  nlohmann::ordered_json cycles_found = nlohmann::ordered_json::array();
  const auto take_cycle = [&](const std::optional<FoundCycle>& cycle) {
    if (!cycle) return;
    cycles->write_row(*cycle);
    cycles_summary.add(*cycle);
    if (options.as_json) cycles_found.push_back(cycle_json(*cycle));
  };
  FigureData figure_data;
  firmware::RunCounts counts;
  {
    Progress progress("replaying", clock);
    const hal::Status status = firmware::run(
        facebow, clock, sensor, settings, counts,
        [&](const Sample& sample, const typename Sensor::Estimate& estimate) {
          const std::optional<EstimateRow> row = row_of_step(sample, estimate);
          if (row && estimates) estimates->write_row(*row);
          if (row && figure_folder) figure_data.add(*row);
          if (row) summary.add(*row);
          if constexpr (firmware::kHasPose<typename Sensor::Estimate>) {
            if (estimate.pose.is_ready) {
              poses->write_row(estimate.pose);
              pose_summary.add(estimate.pose);
            }
          }
          if constexpr (std::is_base_of_v<RecommendedEstimate<double>, typename Sensor::Estimate>) {
            if (cycles) take_cycle(followed_cycles.add(estimate));
          }
          progress.show(facebow.progress());
        },
        [&] { return stop_requested() || !facebow.problem().empty(); });
    if (!facebow.problem().empty()) throw InputError(facebow.problem());
    if (status == hal::Status::ok) {
      print_error(fmt::format("stopped after {} samples; no file was left", counts.samples));
      return kExitInterrupted;
    }
  }

  if (cycles) take_cycle(followed_cycles.finish());
  const std::vector<std::string> drive_notes = summary.drive_notes();
  // Write and close everything before renaming anything.
  const std::string name = recording_name(options.recording);
  std::vector<std::unique_ptr<OutputFile>> figures;
  if (figure_folder) figures = draw_figures(options.figures, name, figure_data);
  std::unique_ptr<OutputFolder> value_folder;
  std::vector<std::unique_ptr<OutputFile>> values;
  std::vector<std::string> value_notes;
  if (!options.values.empty()) {
    value_folder = std::make_unique<OutputFolder>(options.values);
    value_notes =
        write_device_values(options.recording, options.reading.profile, options.values, values);
    for (const auto& file : values) {
      refuse_same_files({options.recording, options.estimator.parameters, options.reading.profile,
                         options.out, options.pose.file, options.cycles.file},
                        {file->path()});
    }
  }
  if (estimates) estimates->close();
  if (poses) poses->close();
  if (cycles) cycles->close();
  if (learned_file) {
    learned_file->write(learned());
    learned_file->close();
  }
  if (stop_requested()) {
    return report_stop();
  }
  if (estimates) estimates->commit();
  if (poses) poses->commit();
  if (cycles) cycles->commit();
  if (learned_file) learned_file->commit();
  for (const auto& figure : figures) figure->commit();
  for (const auto& file : values) file->commit();

  if (options.as_json) {
    nlohmann::ordered_json cycles_json;
    if (cycles) {
      cycles_json = cycles_summary.json();
      cycles_json["found"] = std::move(cycles_found);
    }
    print_output(
        summary_json(options, facebow.info(), drive_notes, summary, pose_summary, cycles_json));
    return kExitOk;
  }
  ReportText report(12);
  const auto line = [&report](const char* label, const std::string& words) {
    report.line(label, words);
  };
  line("recording", recording_text(options, facebow.info()));
  for (const std::string& note : facebow.info().notes) line("note", note);
  if (begins_as_session(facebow.info(), options.estimator, options.learned))
    line("learned", "begins as the session did, with what an earlier one had taught");
  for (const std::string& note : drive_notes) line("note", note);
  report.add(summary.text());
  if (poses) line("pose", pose_summary.text());
  if (estimates) line("estimates", options.out);
  if (poses) line("poses", options.pose.file);
  if (cycles) {
    line("cycles", cycles_summary.text());
    line("cycles", options.cycles.file);
  }
  if (learned_file) line("learned", options.learned.out);
  for (const auto& figure : figures) {
    if (figure->path().ends_with(".png")) line("figure", figure->path() + " (and .svg)");
  }
  for (const auto& file : values) line("values", file->path());
  for (const std::string& note : value_notes) line("note", note);
  if (figure_folder && figures.empty())
    line("figures", !deferred_problems().empty() ? "none: see the error"
                                                 : "none: there are no values to draw");
  print_output(report.text());
  if (!summary.unusable().empty()) return kExitOk;
  for (const std::string& warning : summary.warnings()) print_error("warning: " + warning);
  for (const std::string& warning : pose_warnings(options, pose_summary)) {
    print_error("warning: " + warning);
  }
  return kExitOk;
}

int replay_published(const ReplayOptions& options, ReplayFacebow& facebow, hal::Clock& clock,
                     firmware::RunSettings settings) {
  const PublishedParameters parameters =
      load_published_for(options.estimator, facebow.median_step_ns(), options.recording);
  settings.nominal_step_ns = nanoseconds(parameters.sample_time_s);
  PublishedSensor<double> sensor(parameters, options.followed);
  PublishedSummary summary(parameters, options.followed.axis);
  return replay_through(
      options, facebow, clock, settings, sensor, 0, false, nullptr,
      [&](const Sample& sample, const PublishedEstimate<double>& estimate) {
        return std::optional(row_of(sample, options.followed, estimate));
      },
      summary);
}

int replay_recommended(const ReplayOptions& options, ReplayFacebow& facebow, hal::Clock& clock,
                       const firmware::RunSettings& settings) {
  const RecordingInfo& info = facebow.info();
  RecommendedParameters parameters =
      load_recommended_for(options.estimator, info, options.recording);
  refuse_long_step(parameters, seconds(settings.nominal_step_ns), options.recording,
                   "its median step", kCheckTimes);
  BodyFits fits;
  options.drive_stated.apply(parameters.impedance);
  RecommendedSummary summary(parameters, options.estimator.lag, options.followed.axis, fits);
  const auto run = [&](auto& sensor, bool has_impedance) {
    options.learned.refuse_unless(sensor.learns());
    const int axes = info.kind == SampleKind::one_axis ? 1 : 3;
    std::function<std::string()> learned;
    if (sensor.learns()) {
      summary.set_learning([&sensor](int axis) { return sensor.learning(axis); });
      learned = [&sensor, axes] { return learned_text(learned_of(sensor, axes)); };
      begin_with(sensor,
                 first_learned(options.learned, info, options.estimator, options.recording, axes,
                               seconds(settings.nominal_step_ns), parameters.learning.kernels));
    }
    return replay_through(
        options, facebow, clock, settings, sensor, axes, has_impedance, learned,
        [&](const Sample&, const auto& estimate) {
          return estimate.is_ready ? std::optional(row_of(estimate, options.followed.axis))
                                   : std::nullopt;
        },
        summary);
  };
  std::optional<DriveChannel> channel;
  if (!options.drive.empty()) {
    channel.emplace(options.drive, options.reading.faults, options.recording);
  }
  return firmware::with_hosted_sensor(
      {info.kind, channel || info.has_drive, parameters, options.estimator.lag,
       options.point(&fits), options.followed.axis},
      [&]<class Sensor>(std::type_identity<Sensor>, const auto&... arguments) {
        const auto conclude = [&](auto& sensor) {
          summary.set_conclusion([&] { return sensor.conclude(); });
          summary.set_drive([&] { return sensor.notes(); });
          return run(sensor, true);
        };
        DriveChannel* const drive = channel ? &*channel : nullptr;
        const double delay_s = parameters.impedance.drive.delay_s;
        if (options.pose.file.empty()) {
          if constexpr (firmware::kIdentifying<Sensor>) {
            ReplayedDriveSensor<Sensor> sensor(drive, delay_s, arguments...);
            return conclude(sensor);
          } else {
            Sensor sensor(arguments...);
            return run(sensor, false);
          }
        }
        const PoseSensor<double> pose(parameters, options.estimator.lag);
        if constexpr (firmware::kIdentifying<Sensor>) {
          firmware::SensorWithPose<ReplayedDriveSensor<Sensor>> sensor(pose, drive, delay_s,
                                                                       arguments...);
          return conclude(sensor);
        } else {
          firmware::SensorWithPose<Sensor> sensor(pose, arguments...);
          return run(sensor, false);
        }
      });
}

int replay(const ReplayOptions& options) {
  refuse_same_files({options.recording, options.estimator.parameters, options.reading.profile,
                     options.drive, options.learned.begin_with},
                    {options.out, options.pose.file, options.cycles.file, options.learned.out});
  static_cast<void>(options.pose.choice());  // to report bad points before the work
  hal::SteadyClock clock;
  ReplayFacebow facebow(options.recording, options.reading, options.speed, clock);
  if (facebow.open() != hal::Status::ok) throw InputError(facebow.problem());
  const RecordingInfo& info = facebow.info();
  options.check(options.recording, info);
  const firmware::RunSettings settings = facebow.run_settings(options.followed);
  options.estimator.refuse_if_published("--lag", options.estimator.lag > 0);
  options.estimator.refuse_if_published("--jaw-point-mm", !options.jaw_point_mm.empty());
  options.estimator.refuse_if_published("--pose", !options.pose.file.empty());
  options.estimator.refuse_if_published("--cycles", !options.cycles.file.empty());
  if (!options.pose.file.empty()) {
    refuse_without_pose(options.recording, info.kind, "leave out --pose");
  }
  if (options.estimator.is_published()) options.learned.refuse_unless(false);
  options.estimator.refuse_if_published("--resample-Hz", options.out_form.resample_Hz.has_value());
  options.estimator.refuse_if_published("--drive",
                                        !options.drive.empty() || options.drive_stated.is_given());
  if (!options.drive.empty() && info.has_drive) {
    throw InputError(options.recording, "has a drive of its own",
                     info.is_of_device
                         ? "leave out --drive"
                         : "leave out --drive, or its column with --ignore-column drive_N");
  }
  if (options.drive.empty() && options.drive_stated.is_given() && !info.has_drive) {
    throw InputError(options.recording, "has no drive, so options of the drive do not apply",
                     "give one with --drive FILE");
  }
  if (options.estimator.is_published()) {
    return replay_published(options, facebow, clock, settings);
  }
  return replay_recommended(options, facebow, clock, settings);
}

}  // namespace

Command add_replay(CommandLine app) {
  auto options = std::make_shared<ReplayOptions>();
  const CommandLine command = app.add_command(
      "replay", "Estimate motion, force and, with a drive, friction and mass from a recording",
      "Analyse recordings");
  command.add_example("condyle replay jaw.csv --out estimates.csv --figures figures",
                      "Write one row of estimates for each sample, and draw them.");
  command.add_example("condyle replay jaw.csv --drive jaw.drive.csv --drive-missing 0",
                      "Measure friction and mass with a complete force sensor.");
  command.add_example("condyle replay jaw.csv --pose pose.csv --pose-point incisor 0 80 -30",
                      "Write the whole pose of each sample, and the motion of the incisor.");
  command
      .add_option("RECORDING", options->recording,
                  "CSV, ArtiSynth probe text, Zebris XML, SSFF, session log (MCAP) or capture of "
                  "USB traffic (pcap, pcapng), recognised by its content; A+B+C, three of one "
                  "point each; or sim:SCENARIO.toml")
      .required();
  add_estimator_options(command, options->estimator);
  add_learned_options(command, options->learned);
  add_recording_options(command, *options);
  add_pose_options(command, options->pose);
  add_cycle_options(command, options->cycles);
  command.add_option("--speed", options->speed, "0 as fast as possible, 1 real time")
      .number_in({0, 1e6})
      .show_default();
  command.add_option(
      "--drive=FILE", options->drive,
      "Total force along the followed axis, in its own file: CSV with time_s and "
      "drive_N, or a session log; or analog:NAME, an analogue channel of the recording");
  add_drive_options(command, options->drive_stated);
  command.group("Output").add_flag("--json", options->as_json,
                                   "Print the summary as JSON, for programs");
  const Option out = command.group("Output").add_option("-o,--out=FILE", options->out,
                                                        "CSV file for the estimates");
  add_table_options(command, options->out_form, out);
  command.group("Output").add_option(
      "--values=FOLDER", options->values,
      "Folder for the other values that devices of a session log or capture measured: force, "
      "EMG (CSV)");
  command.group("Output").add_option("--figures=FOLDER", options->figures,
                                     "Folder for figures (SVG and PNG)");
  return [options] { return replay(*options); };
}

}  // namespace condyle::host
