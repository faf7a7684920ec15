// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "commands/commands.h"
#include "commands/live_files.h"
#include "commands/record_monitor.h"
#include "condyle/firmware/latency_histogram.h"
#include "condyle/firmware/run_loop.h"
#include "condyle/firmware/sensor_choice.h"
#include "condyle/firmware/sensor_with_pose.h"
#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/device_facebow.h"
#include "hosted/config/parameter_file.h"
#include "hosted/devices/device_text.h"
#include "hosted/devices/run_settings.h"
#include "hosted/devices/session_device.h"
#include "hosted/devices/source_spec.h"
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"
#include "hosted/files/wall_clock.h"
#include "hosted/lsl/estimate_stream.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "options/stream_options.h"
#include "output/lasting_effect.h"
#include "output/live_estimates.h"
#include "output/report_text.h"

namespace condyle::host {
namespace {

struct RecordOptions {
  std::vector<std::string> companions;  // profiles
  std::string source, profile, out, estimates, parameters, subject;
  std::string backend = "hidapi";
  std::string serial;
  FollowedChoice choice;
  lsl::StreamChoice stream;
  std::string lsl_out;
  PoseOptions pose;
  CycleOptions cycles;
  LearnedFiles learned;
  double duration_s = 0, idle_s = 0;
  std::uint64_t samples = 0;
};

std::string latency_text(const firmware::LatencyHistogram& latency) {
  if (latency.count() == 0) return "no samples";
  const auto us = [](TimeNs time_ns) { return static_cast<double>(time_ns) * 1e-3; };
  return fmt::format("p50 {:.3g} us, p99 {:.3g} us, at most {:.3g} us from arrival to estimate",
                     us(latency.quantile_ns(0.5)), us(latency.quantile_ns(0.99)),
                     us(latency.largest_ns()));
}

std::string summary(const RecordOptions& options, const SessionDevice& device,
                    const hal::DeviceFacebow& facebow, const hal::SessionLogStatus& log,
                    const std::vector<std::unique_ptr<RecordedCompanion>>& companions,
                    const LiveFiles& files, const firmware::LatencyHistogram& latency,
                    TimeNs elapsed_ns) {
  const hal::DeviceProfile& profile = device.profile;
  ReportText report(12);
  const auto line = [&report](const char* label, const std::string& words) {
    report.line(label, words);
  };
  line("device",
       device.inlet ? profile.name : fmt::format("{}, through {}", profile.name, options.backend));
  if (device.inlet) line("clock", lsl::clock_text(*device.inlet));
  line("duration", fmt::format("{:.3f} s", seconds(elapsed_ns)));
  line("reports", reports_text(profile, facebow.counts(), facebow.transport_counts()));
  if (profile.device_time) line("clock", clock_text(facebow.clock_fit()));
  line("latency", latency_text(latency));
  for (const auto& companion : companions) {
    const hal::DeviceFacebow& beside = companion->companion.device();
    line("companion", companion->profile.name);
    line("reports", reports_text(companion->profile, beside.counts(), beside.transport_counts()));
    if (companion->profile.device_time) line("clock", clock_text(beside.clock_fit()));
  }
  line("recording",
       fmt::format("{}: {} reports, {} events, {} bytes; {} reports and {} events were dropped",
                   options.out, log.reports_written, log.events_written, log.bytes_written,
                   log.reports_lost, log.events_lost));
  const auto live_line = [&](const char* label, const std::string& path, const auto& file) {
    if (!file) return;
    const std::uint64_t dropped = file->dropped();
    line(label, path + (dropped > 0 ? fmt::format("; {} rows were dropped", dropped) : ""));
  };
  live_line("estimates", options.estimates, files.estimates);
  live_line("poses", options.pose.file, files.poses);
  live_line("cycles", options.cycles.file, files.cycles);
  if (files.learned && files.learned_problem.empty()) line("learned", options.learned.out);
  if (files.stream) line("stream", files.stream->summary());
  return report.text();
}

int record_devices(const RecordOptions& options, const std::vector<SessionDevice>& devices,
                   const RecommendedParameters& parameters, const LearnedMotion& prior,
                   hal::SessionLogWriter& log, LiveFiles& files, hal::Clock& clock) {
  const hal::DeviceProfile& profile = devices.front().profile;
  hal::RecordedSource source(devices.front().source(), log, 0, clock);
  hal::DeviceFacebow facebow(source, hal::layout_of(profile));
  // The device was found a moment ago, so any failure is treated like an unplugging: wait for it.
  bool has_failed = false;
  while (facebow.open() != hal::Status::ok && !stop_requested()) {
    if (!has_failed) print_error("the device can no longer be opened; waiting for it");
    has_failed = true;
    clock.sleep_until(clock.now_ns() + 20'000'000);
  }
  std::vector<std::unique_ptr<RecordedCompanion>> companions;
  for (std::size_t i = 1; i < devices.size(); ++i) {
    companions.push_back(std::make_unique<RecordedCompanion>(devices[i], log, i, clock));
    companions.back()->companion.start();
  }
  const firmware::RunSettings settings = run_settings_of(profile, options.choice.followed);
  firmware::RunCounts counts;
  firmware::LatencyHistogram latency;
  Monitor monitor(facebow, devices.front(), companions, clock);
  FollowedCycles cycles(options.cycles.choice(options.choice.followed.axis));
  const auto take_cycle = [&](const std::optional<FoundCycle>& cycle) {
    if (cycle) files.cycles->add(*cycle);
  };
  std::uint64_t disconnections = 0;
  const auto mark_disconnections = [&] {
    if (!files.stream || facebow.transport_counts().disconnections == disconnections) return;
    disconnections = facebow.transport_counts().disconnections;
    files.stream->mark("facebow disconnected");
  };
  if (files.stream) files.stream->mark("recording started");
  const auto run = [&](auto sensor) {
    begin_with(sensor, prior);
    (void)firmware::run(
        facebow, clock, sensor, settings, counts,
        [&](const Sample&, const auto& estimate) {
          latency.add(clock.now_ns() - facebow.last_arrival_ns());
          if (files.estimates && estimate.is_ready) {
            files.estimates->add(row_of(estimate, options.choice.followed.axis));
          }
          if (files.stream && estimate.is_ready) files.stream->add(estimate);
          if (files.cycles) take_cycle(cycles.add(estimate));
          if constexpr (firmware::kHasPose<std::remove_cvref_t<decltype(estimate)>>) {
            if (estimate.pose.is_ready) files.poses->add(estimate.pose);
          }
        },
        [&] {
          monitor.look();
          mark_disconnections();
          return stop_requested() || log.status().failure != hal::SessionLogFailure::none ||
                 (options.samples > 0 && counts.samples >= options.samples) ||
                 (options.idle_s > 0 && seconds(monitor.idle_ns()) >= options.idle_s) ||
                 (options.duration_s > 0 && seconds(monitor.elapsed_ns()) >= options.duration_s);
        });
    if (!sensor.learns()) return;
    const int axes = profile.kind == SampleKind::one_axis ? 1 : 3;
    const std::string learned = learned_text(learned_of(sensor, axes));
    const bool has_learned = sensor.corrector(0).learned() > 0;
    if (has_learned && !log.keep_learned(learned))
      print_error("what was learned is too long for the log");
    files.learned_words = learned;
  };
  firmware::with_hosted_sensor(
      {profile.kind, profile.drive_N.has_value(), parameters, 0, options.choice.point(),
       options.choice.followed.axis},
      [&]<class Sensor>(std::type_identity<Sensor>, const auto&... arguments) {
        if (files.poses) {
          run(firmware::SensorWithPose<Sensor>(PoseSensor<double>(parameters), arguments...));
        } else {
          run(Sensor(arguments...));
        }
      });
  if (files.cycles) take_cycle(cycles.finish());
  monitor.end_line();
  const TimeNs elapsed_ns = monitor.elapsed_ns();
  facebow.close();
  if (files.stream) files.stream->mark("recording stopped");
  for (const auto& companion : companions) companion->companion.stop();
  const hal::SessionLogFailure failure = log.close();
  files.finish();
  const bool is_told = try_to_print(summary(options, devices.front(), facebow, log.status(),
                                            companions, files, latency, elapsed_ns));
  const bool is_complete = failure == hal::SessionLogFailure::none;
  if (!is_complete) {
    print_error(fmt::format("{}: recording stopped: {}; the part already on the disk is intact",
                            options.out, hal::session_log_failure_name(failure)));
  }
  const std::string problems = files.problems();
  const char* const mend = "; the recording is complete; replay it to get the file";
  if (!problems.empty()) print_error(problems + (is_complete ? mend : ""));
  return is_told && is_complete && problems.empty() ? kExitOk : kExitBadInput;
}

// FILE, or FILE@SERIAL if no file has the whole text as its name.
std::pair<std::string, std::string> split_serial(const std::string& text) {
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos || std::filesystem::exists(text)) return {text, ""};
  return {text.substr(0, at), text.substr(at + 1)};
}

// The facebow that SOURCE or --profile names.
SessionDevice facebow_of(const RecordOptions& options, hal::Clock& clock) {
  if (options.source.empty() == options.profile.empty()) {
    throw InputError(
        options.source.empty() ? "SOURCE" : options.source,
        options.source.empty() ? "the facebow is not named" : "--profile names a second facebow",
        "give either --profile FILE or a source, such as lsl:NAME");
  }
  auto stream = parse_stream(options.source);
  refuse_without_stream(options.stream, stream.has_value());
  if (options.source.empty()) {
    return make_session_device(options.profile, options.serial, options.backend, clock);
  }
  if (stream) {
    stream->choice = options.stream;
    return make_session_stream(*stream, clock, stop_requested);
  }
  const auto spec = parse_source(options.source);
  if (spec && (spec->kind == SourceKind::hid || spec->kind == SourceKind::usb)) {
    return make_session_device(spec->file, options.serial, backend_of(spec->kind), clock);
  }
  throw InputError(options.source, "is not a source that can be recorded",
                   "write hid:PROFILE, usb:PROFILE or lsl:NAME");
}

int record(const RecordOptions& options) {
  if (!hal::is_subject_code(options.subject)) {
    throw InputError("--subject", "is not a valid pseudonym",
                     "use at most 32 letters, digits, - and _, and not a person's name");
  }
  if (options.out == "-") {
    throw InputError("--out -", "a session log cannot go to standard output",
                     "name a file; --estimates - writes the estimates there");
  }
  std::vector<std::pair<std::string, std::string>> companions;  // file, serial number
  std::vector<std::string> inputs = {options.profile, options.parameters};
  for (const std::string& text : options.companions) {
    companions.push_back(split_serial(text));
    inputs.push_back(companions.back().first);
  }
  inputs.push_back(options.learned.begin_with);
  refuse_same_files(inputs, {options.out, options.estimates, options.pose.file, options.cycles.file,
                             options.learned.out});
  if (options.companions.size() >= hal::kMaxSessionSources) {
    throw InputError("--companion", "too many devices for one log",
                     fmt::format("give at most {}", hal::kMaxSessionSources - 1));
  }
  hal::SteadyClock clock;
  std::vector<SessionDevice> devices;
  devices.push_back(facebow_of(options, clock));
  const std::string& name = devices.front().name;
  require_position(devices.front().profile, name);
  for (const auto& [file, serial] : companions) {
    devices.push_back(make_session_device(file, serial, options.backend, clock));
  }
  reject_duplicate_devices(devices);
  const SampleKind kind = devices.front().profile.kind;
  options.choice.check(name, kind);
  const PoseChoice pose = options.pose.choice();
  if (!options.pose.file.empty()) refuse_without_pose(name, kind, "leave out --pose");
  for (SessionDevice& device : devices) probe_device(device, stop_requested);

  hal::SessionHeader header;
  header.software_version = "condyle " CONDYLE_VERSION;
  header.subject_code = options.subject;
  if (!options.parameters.empty()) header.parameters_toml = read_text_file(options.parameters);
  header.start_monotonic_ns = clock.now_ns();
  header.start_wall_ns = wall_ns();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const SessionDevice& device = devices[i];
    header.sources.push_back({i == 0 ? "facebow" : fmt::format("companion-{}", i),
                              device.profile.vendor_id, device.profile.product_id,
                              device.profile_text, device.descriptor});
  }
  RecommendedParameters parameters;
  if (!options.parameters.empty()) parameters = load_recommended_parameters(options.parameters);
  const int axes = kind == SampleKind::one_axis ? 1 : 3;
  options.learned.refuse_unless(parameters.learning.kernels >= 1);
  LearnedMotion prior;
  if (!options.learned.begin_with.empty()) {
    const double rate_Hz = devices.front().profile.rate_Hz;
    prior = read_learned(options.learned.begin_with, axes, rate_Hz > 0 ? 1 / rate_Hz : 0,
                         parameters.learning.kernels, 0);
    header.begun_with_json = learned_text(prior);
  }
  LiveFiles files;
  if (!options.learned.out.empty()) {
    files.learned = std::make_unique<OutputFile>(options.learned.out);
  }
  if (!options.estimates.empty()) {
    files.estimates = std::make_unique<LiveEstimates>(
        options.estimates, axes, devices.front().profile.drive_N.has_value(), TableForm(),
        parameters.learning.kernels >= 1);
  }
  if (!options.pose.file.empty()) {
    files.poses = std::make_unique<LivePoses>(options.pose.file, pose);
  }
  if (!options.cycles.file.empty()) {
    files.cycles = std::make_unique<LiveCycles>(options.cycles.file);
  }
  if (!options.lsl_out.empty()) {
    lsl::check_outlet_place(options.lsl_out);
    const hal::DeviceProfile& profile = devices.front().profile;
    files.stream = std::make_unique<lsl::EstimateStream>(
        lsl::EstimateStreamSettings{options.lsl_out, axes, profile.drive_N.has_value(),
                                    profile.rate_Hz},
        clock);
  }
  hal::SessionLogWriter log;
  const hal::SessionLogFailure failure = log.open(options.out, header);
  if (failure == hal::SessionLogFailure::bad_header) {
    throw InputError(options.out, hal::header_problem(header), "");
  }
  if (failure != hal::SessionLogFailure::none) {
    throw InputError(options.out, hal::session_log_failure_name(failure),
                     "name a new file in a writable folder");
  }
  has_lasting_effect = true;
  return record_devices(options, devices, parameters, prior, log, files, clock);
}

}  // namespace

Command add_record(CommandLine app) {
  auto options = std::make_shared<RecordOptions>();
  const CommandLine command = app.add_command(
      "record", "Record the raw reports of a facebow, and estimate live; Ctrl-C ends the recording",
      "Measure with a device");
  command.add_example("condyle record --profile bow.toml --out session.mcap",
                      "Record until Ctrl-C.");
  command.add_example(
      "condyle record --profile bow.toml --out session.mcap --estimates live.csv --companion "
      "force.toml",
      "Also write live estimates, and record a force sensor beside the facebow.");
  command.add_option("SOURCE", options->source,
                     "lsl:NAME, a stream of the Lab Streaming Layer; hid:PROFILE or usb:PROFILE, "
                     "a device");
  command.add_option("--profile=FILE", options->profile, kProfileMeaning);
  command.group("Output")
      .add_option("-o,--out=FILE", options->out, "Session log to write (MCAP); must not exist")
      .required();
  command.add_option("--backend", options->backend, "hidapi: the kernel's driver; libusb: directly")
      .one_of({"hidapi", "libusb"})
      .show_default();
  command.add_option("--serial", options->serial, "Serial number, if several are plugged in");
  command
      .add_option("--companion", options->companions,
                  "Profile of an instrument to record beside the facebow, such as a force sensor; "
                  "FILE@SERIAL if several are plugged in; may be given several times")
      .one_value_each();
  add_stream_options(command, options->stream);
  add_stream_outlet_option(command, options->lsl_out);
  command.add_option("--subject", options->subject, "Pseudonymous code of the subject");
  command.add_option("--estimates=FILE", options->estimates, "CSV file for the estimates");
  command.add_option("--parameters=FILE", options->parameters,
                     "TOML file with parameters of the recommended estimator");
  add_followed_options(command, options->choice);
  add_pose_options(command, options->pose);
  add_cycle_options(command, options->cycles);
  add_learned_options(command, options->learned);
  command.add_option("--duration-s", options->duration_s, "Stop after this time; 0: never")
      .number_in({0, 1e7})
      .show_default();
  command.add_option("--idle-s", options->idle_s, "Stop after this time without a report; 0: never")
      .number_in({0, 1e7})
      .show_default();
  command.add_option("--samples", options->samples, "Stop after this number of samples; 0: never")
      .show_default();
  return [options] { return record(*options); };
}

}  // namespace condyle::host
