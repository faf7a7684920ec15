// SPDX-License-Identifier: Apache-2.0
// Detects changes of effective damping in a recording with a measured drive.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "changes/change_report.h"
#include "commands/commands.h"
#include "condyle/estimator/sensors/cycle_sensor.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/firmware/sensor_choice.h"
#include "condyle/hal/clock.h"
#include "estimation/replayed_drive.h"
#include "hosted/config/parameter_file.h"
#include "hosted/files/input_error.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "output/progress.h"
#include "output/report_text.h"
#include "recordings/recording_files.h"
#include "recordings/replay_facebow.h"

namespace condyle::host {
namespace {

struct ChangesOptions : RecordingChoice {
  std::string recording, drive, parameters, out, figures;
  DriveStatement drive_stated;
  double false_alarm_interval_h = 0;
  std::optional<double> smallest_change_Ns_m;
};

// The result of the recording.
struct WatchedRecording {
  std::vector<TimedCycle<double>> cycles;
  ImpedanceEstimate<double> identified;
  std::optional<TimeNs> watched_from_ns;
  std::vector<std::string> notes;
};

RecommendedParameters choose_parameters(const ChangesOptions& options, const RecordingInfo& info) {
  RecommendedParameters parameters;
  if (!options.parameters.empty()) {
    parameters = load_recommended_parameters(options.parameters);
  } else if (!info.parameters_toml.empty()) {
    parameters =
        parse_recommended_parameters(options.recording + ": its parameters", info.parameters_toml);
  }
  options.drive_stated.apply(parameters.impedance);
  double& change_Ns_m = parameters.changes.detector.change_Ns_m;
  change_Ns_m = options.smallest_change_Ns_m.value_or(change_Ns_m);
  if (parameters.impedance.coulomb_N.mean != 0 || parameters.impedance.coulomb_N.sd != 0) {
    throw InputError(
        "--coulomb-sd-N",
        "this command counts all friction as effective damping, including Coulomb friction",
        "leave it out, and remove coulomb_N and coulomb_sd_N from the parameter file");
  }
  // With a share of 1, a change of the missing force looks like a change of damping.
  if (parameters.impedance.drive.missing_share >= 1) {
    throw InputError(
        "--drive-missing",
        "must be given, below 1: a change of damping is known only if the share of the "
        "force that the drive misses is known",
        "state the largest share of the total force (0 to 1) that the drive may miss");
  }
  return parameters;
}

void check(const ChangesOptions& options, const RecordingInfo& info) {
  options.RecordingChoice::check(options.recording, info);
  if (!options.drive.empty() && info.has_drive) {
    throw InputError(options.recording, "has a drive of its own",
                     info.is_of_device
                         ? "leave out --drive"
                         : "leave out --drive, or its column with --ignore-column drive_N");
  }
  if (options.drive.empty() && !info.has_drive) {
    throw InputError(
        options.recording,
        "has no drive; the damping is known only if the force that moves the jaw is measured",
        "give one with --drive FILE");
  }
}

template <int kAxes>
WatchedRecording watch(const ChangesOptions& options, const RecommendedParameters& parameters,
                       int axis, ReplayFacebow& facebow, hal::Clock& clock) {
  const RecordingInfo& info = facebow.info();
  const firmware::RunSettings settings = facebow.run_settings(options.followed);
  refuse_long_step(parameters, seconds(settings.nominal_step_ns), options.recording,
                   "its median step", kCheckTimes);
  std::optional<DriveChannel> channel;
  if (!options.drive.empty()) {
    channel.emplace(options.drive, options.reading.faults, options.recording);
  }
  ReplayedDriveSensor<CycleSensor<double, kAxes>> sensor(channel ? &*channel : nullptr,
                                                         parameters.impedance.drive.delay_s,
                                                         parameters, options.point(), axis);
  WatchedRecording result;
  firmware::RunCounts counts;
  Progress progress("watching", clock);
  (void)firmware::run(
      facebow, clock, sensor, settings, counts,
      [&](const Sample&, const CycleEstimate<double>& estimate) {
        for (std::size_t i = 0; i < estimate.cycle_count; ++i)
          result.cycles.push_back(estimate.cycles[i]);
        if (!result.watched_from_ns && sensor.timeline().is_watching()) {
          result.watched_from_ns = estimate.time_ns;
        }
        progress.show(facebow.progress());
      },
      [&] { return stop_requested() || !facebow.problem().empty(); });
  if (!facebow.problem().empty()) throw InputError(facebow.problem());
  result.identified = sensor.timeline().identified();
  result.notes = info.notes;
  for (const std::string& note : sensor.notes()) {
    result.notes.push_back(note);
  }
  return result;
}

// Why no cycle was watched.
[[noreturn]] void refuse_unwatched(const ChangesOptions& options,
                                   const RecommendedParameters& parameters, ImpedanceLimit limit) {
  if (is_failure(limit) && limit != ImpedanceLimit::no_drive &&
      limit != ImpedanceLimit::too_early) {
    throw InputError(options.recording,
                     fmt::format("drive and model do not explain the motion, so the damping is not "
                                 "known ({}; run `condyle replay` for details)",
                                 limit_name(limit)),
                     "measure the total force, unfiltered, and leave out contacts");
  }
  throw InputError(
      options.recording,
      fmt::format("is too short to identify the point, which takes {:g} s of motion with its drive",
                  parameters.changes.identification_s),
      "record longer");
}

// The interval in cycles is known only now.
void check_interval(const ChangesOptions& options, const RecommendedParameters& parameters,
                    const ChangeWatch& found) {
  ChangeParameters detector = parameters.changes.detector;
  detector.false_alarm_cycles = found.false_alarm_cycles;
  if (found.counted == 0 || is_valid(detector)) return;
  throw InputError("--false-alarm-interval-h",
                   fmt::format("{:g} h are {:.3g} cycles of this recording",
                               options.false_alarm_interval_h, found.false_alarm_cycles),
                   "choose an interval of 100 to 1e9 cycles");
}

int changes(const ChangesOptions& options) {
  refuse_same_files({options.recording, options.parameters, options.drive, options.reading.profile},
                    {options.out});
  hal::SteadyClock clock;
  ReplayFacebow facebow(options.recording, options.reading, 0, clock);
  if (facebow.open() != hal::Status::ok) throw InputError(facebow.problem());
  check(options, facebow.info());
  const RecommendedParameters parameters = choose_parameters(options, facebow.info());
  // Opened first, to report an output that cannot be written before the work.
  std::unique_ptr<OutputFolder> folder;
  if (!options.figures.empty()) folder = std::make_unique<OutputFolder>(options.figures);
  std::vector<std::unique_ptr<OutputFile>> files;
  if (!options.out.empty()) files.push_back(std::make_unique<OutputFile>(options.out));

  const WatchedRecording recording =
      firmware::with_axes(facebow.info().kind, options.followed.axis, [&](auto axes, int axis) {
        return watch<decltype(axes)::value>(options, parameters, axis, facebow, clock);
      });
  if (stop_requested()) {
    return report_stop();
  }
  if (!recording.watched_from_ns) {
    refuse_unwatched(options, parameters, recording.identified.mass_kg.limit);
  }
  const ImpedanceEstimate<double>& identified = recording.identified;
  WatchSettings settings{parameters.changes.detector, options.false_alarm_interval_h,
                         parameters.impedance.drive, identified.mass_kg.fitted};
  if (parameters.impedance.delay == DelayModel::fitted) {
    settings.drive.delay_sd_s = identified.delay_s.fitted_sd;
  }
  const ChangeWatch found = watch_cycles(recording.cycles, settings);
  check_interval(options, parameters, found);
  if (!options.out.empty()) {
    files.back()->write(changes_csv(found));
    files.back()->close();
  }
  if (folder) {
    const auto name = recording_name(options.recording);
    for (auto& figure : draw_changes(options.figures, name, found)) {
      files.push_back(std::move(figure));
    }
  }
  ReportText report(14);
  report.line("recording", fmt::format("{}, {}", options.recording, facebow.info().format));
  for (const std::string& note : recording.notes) report.line("note", note);
  report.line(
      "identified",
      fmt::format("until {:.1f} s: about {:.3g} Ns/m, {:.3g} kg, {:.3g} N/m; the cycles after it "
                  "are watched",
                  seconds(*recording.watched_from_ns), identified.friction_Ns_m.fitted,
                  identified.mass_kg.fitted, identified.stiffness_N_m.fitted));
  report.add(changes_text(found, settings));
  report.add(commit_all(files));
  print_output(report.text());
  return kExitOk;
}

}  // namespace

Command add_changes(CommandLine app) {
  auto options = std::make_shared<ChangesOptions>();
  const CommandLine command = app.add_command(
      "changes", "Detect changes in effective damping, if the total drive is measured",
      "Analyse recordings");
  command.add_example(
      "condyle changes chewing.csv --drive chewing.drive.csv --drive-missing 0 "
      "--false-alarm-interval-h 8",
      "Watch the damping of each chewing cycle.");
  command.add_example(
      "condyle changes chewing.csv --drive chewing.drive.csv --drive-missing 0 "
      "--false-alarm-interval-h 8 --out cycles.csv",
      "Also write a row for each cycle.");
  command.add_option("RECORDING", options->recording, "As for replay").required();
  command
      .add_option("--false-alarm-interval-h", options->false_alarm_interval_h,
                  "Hours of chewing between two false alarms, on average")
      .required()
      .number_in({1e-6, 1e9});
  command
      .add_option("--smallest-change-Ns-m", options->smallest_change_Ns_m,
                  "Smallest lasting change that matters to you (0.05)")
      .number_in({1e-9, 1e6});
  command.add_option(
      "--drive=FILE", options->drive,
      "Total force along the followed axis, in its own file: CSV with time_s and "
      "drive_N, or a session log; or analog:NAME, an analogue channel of the recording");
  add_drive_options(command, options->drive_stated);
  command.add_option("--parameters=FILE", options->parameters, "TOML file, as for replay");
  add_recording_options(command, *options);
  command.group("Output").add_option("-o,--out=FILE", options->out,
                                     "CSV file with one row for each cycle");
  command.group("Output").add_option("--figures=FOLDER", options->figures,
                                     "Folder for figures (SVG and PNG)");
  return [options] { return changes(*options); };
}

}  // namespace condyle::host
