// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <unistd.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "commands/commands.h"
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
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"
#include "hosted/files/wall_clock.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "output/live_estimates.h"
#include "output/report_text.h"

namespace condyle::host {
namespace {

struct RecordOptions {
  std::vector<std::string> companions;  // profiles
  std::string profile, out, estimates, parameters, subject;
  std::string backend = "hidapi";
  std::string serial;
  FollowedChoice choice;
  PoseOptions pose;
  CycleOptions cycles;
  double duration_s = 0, idle_s = 0;
  std::uint64_t samples = 0;
};

// Shows the state of the recording while it runs.
class Monitor {
 public:
  Monitor(const hal::DeviceFacebow& facebow, const SessionDevice& device,
          const std::vector<std::unique_ptr<RecordedCompanion>>& companions, hal::Clock& clock)
      : facebow_(facebow),
        has_counter_(device.profile.sequence.has_value()),
        serial_(device.address.serial),
        companions_(companions),
        were_there_(companions.size(), true),
        clock_(clock),
        begin_ns_(clock.now_ns()) {}

  // Call it often.
  void look() {
    const TimeNs now_ns = clock_.now_ns();
    if (facebow_.counts().received != received_) last_received_ns_ = now_ns;
    received_ = facebow_.counts().received;
    const std::uint64_t disconnections = facebow_.transport_counts().disconnections;
    if (disconnections > disconnections_) {
      disconnections_ = disconnections;
      say(now_ns, "the device was disconnected; waiting for it" +
                      (serial_.empty() ? "" : ", serial number " + serial_));
    }
    for (std::size_t i = 0; i < companions_.size(); ++i) {
      // In the first second the device is still being opened.
      const bool is_there = companions_[i]->companion.is_open() ||
                            (were_there_[i] && now_ns - begin_ns_ < 1'000'000'000);
      if (is_there == were_there_[i]) continue;
      were_there_[i] = is_there;
      say(now_ns, companions_[i]->profile.name +
                      (is_there ? " is back" : " is disconnected; waiting for it"));
    }
    if (!is_terminal_ || now_ns < next_ns_) return;
    next_ns_ = now_ns + 200'000'000;
    const hal::ReportCounts& counts = facebow_.counts();
    std::string text = fmt::format("\rrecording {:.1f} s, {} reports", seconds(now_ns - begin_ns_),
                                   counts.received);
    if (has_counter_) text += fmt::format(", {} lost ", counts.lost);
    std::fputs(text.c_str(), stderr);
    has_line_ = true;
  }
  void end_line() {
    if (has_line_) std::fputc('\n', stderr);
    has_line_ = false;
  }
  TimeNs elapsed_ns() const { return clock_.now_ns() - begin_ns_; }
  TimeNs idle_ns() const { return clock_.now_ns() - last_received_ns_; }

 private:
  void say(TimeNs now_ns, const std::string& words) {
    end_line();
    print_error(fmt::format("{:.3f} s: {}", seconds(now_ns - begin_ns_), words));
  }

  const hal::DeviceFacebow& facebow_;
  bool has_counter_;
  std::string serial_;
  const std::vector<std::unique_ptr<RecordedCompanion>>& companions_;
  std::vector<bool> were_there_;
  hal::Clock& clock_;
  TimeNs begin_ns_, next_ns_ = 0, last_received_ns_ = begin_ns_;
  std::uint64_t received_ = 0, disconnections_ = 0;
  bool is_terminal_ = isatty(STDERR_FILENO) != 0, has_line_ = false;
};

// What is written live; either may be absent.
struct LiveFiles {
  std::unique_ptr<LiveEstimates> estimates;
  std::unique_ptr<LivePoses> poses;
  std::unique_ptr<LiveCycles> cycles;

  void finish() {
    if (estimates) estimates->finish();
    if (poses) poses->finish();
    if (cycles) cycles->finish();
  }
  // Why a file is not complete; empty if all are.
  std::string problem() const {
    std::string problem = estimates ? estimates->problem() : "";
    if (problem.empty() && poses) problem = poses->problem();
    if (problem.empty() && cycles) problem = cycles->problem();
    return problem;
  }
};

std::string latency_text(const firmware::LatencyHistogram& latency) {
  if (latency.count() == 0) return "no samples";
  const auto us = [](TimeNs time_ns) { return static_cast<double>(time_ns) * 1e-3; };
  return fmt::format("p50 {:.3g} us, p99 {:.3g} us, at most {:.3g} us from arrival to estimate",
                     us(latency.quantile_ns(0.5)), us(latency.quantile_ns(0.99)),
                     us(latency.largest_ns()));
}

std::string summary(const RecordOptions& options, const hal::DeviceProfile& profile,
                    const hal::DeviceFacebow& facebow, const hal::SessionLogStatus& log,
                    const std::vector<std::unique_ptr<RecordedCompanion>>& companions,
                    const LiveFiles& files, const firmware::LatencyHistogram& latency,
                    TimeNs elapsed_ns) {
  ReportText report(12);
  const auto line = [&report](const char* label, const std::string& words) {
    report.line(label, words);
  };
  line("device", fmt::format("{}, through {}", profile.name, options.backend));
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
  return report.text();
}

int record_devices(const RecordOptions& options, const std::vector<SessionDevice>& devices,
                   const RecommendedParameters& parameters, hal::SessionLogWriter& log,
                   LiveFiles& files, hal::Clock& clock) {
  const hal::DeviceProfile& profile = devices.front().profile;
  hal::RecordedSource source(devices.front().device->source(), log, 0, clock);
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
  const auto run = [&](auto sensor) {
    (void)firmware::run(
        facebow, clock, sensor, settings, counts,
        [&](const Sample&, const auto& estimate) {
          latency.add(clock.now_ns() - facebow.last_arrival_ns());
          if (files.estimates && estimate.is_ready) {
            files.estimates->add(row_of(estimate, options.choice.followed.axis));
          }
          if (files.cycles) take_cycle(cycles.add(estimate));
          if constexpr (firmware::kHasPose<std::remove_cvref_t<decltype(estimate)>>) {
            if (estimate.pose.is_ready) files.poses->add(estimate.pose);
          }
        },
        [&] {
          monitor.look();
          return stop_requested() || log.status().failure != hal::SessionLogFailure::none ||
                 (options.samples > 0 && counts.samples >= options.samples) ||
                 (options.idle_s > 0 && seconds(monitor.idle_ns()) >= options.idle_s) ||
                 (options.duration_s > 0 && seconds(monitor.elapsed_ns()) >= options.duration_s);
        });
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
  for (const auto& companion : companions) companion->companion.stop();
  const hal::SessionLogFailure failure = log.close();
  files.finish();
  print_output(
      summary(options, profile, facebow, log.status(), companions, files, latency, elapsed_ns));
  if (failure != hal::SessionLogFailure::none) {
    print_error(fmt::format("{}: recording stopped: {}; the part already on the disk is intact",
                            options.out, hal::session_log_failure_name(failure)));
    return kExitBadInput;
  }
  if (files.problem().empty()) return kExitOk;
  print_error(files.problem() + "; the recording is complete; replay it to get the estimates");
  return kExitBadInput;
}

// FILE, or FILE@SERIAL if no file has the whole text as its name.
std::pair<std::string, std::string> split_serial(const std::string& text) {
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos || std::filesystem::exists(text)) return {text, ""};
  return {text.substr(0, at), text.substr(at + 1)};
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
  refuse_same_files(inputs,
                    {options.out, options.estimates, options.pose.file, options.cycles.file});
  if (options.companions.size() >= hal::kMaxSessionSources) {
    throw InputError("--companion", "too many devices for one log",
                     fmt::format("give at most {}", hal::kMaxSessionSources - 1));
  }
  hal::SteadyClock clock;
  std::vector<SessionDevice> devices;
  devices.push_back(make_session_device(options.profile, options.serial, options.backend, clock));
  require_position(devices.front().profile, options.profile);
  for (const auto& [file, serial] : companions) {
    devices.push_back(make_session_device(file, serial, options.backend, clock));
  }
  reject_duplicate_devices(devices);
  const SampleKind kind = devices.front().profile.kind;
  options.choice.check(options.profile, kind);
  const PoseChoice pose = options.pose.choice();
  if (!options.pose.file.empty()) refuse_without_pose(options.profile, kind, "leave out --pose");
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
  LiveFiles files;
  if (!options.estimates.empty()) {
    files.estimates =
        std::make_unique<LiveEstimates>(options.estimates, kind == SampleKind::one_axis ? 1 : 3,
                                        devices.front().profile.drive_N.has_value(),
                                        parameters.learning.kernels >= 1);
  }
  if (!options.pose.file.empty()) {
    files.poses = std::make_unique<LivePoses>(options.pose.file, pose);
  }
  if (!options.cycles.file.empty()) {
    files.cycles = std::make_unique<LiveCycles>(options.cycles.file);
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
  return record_devices(options, devices, parameters, log, files, clock);
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
  command.add_option("--profile=FILE", options->profile, kProfileMeaning).required();
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
  command.add_option("--subject", options->subject, "Pseudonymous code of the subject");
  command.add_option("--estimates=FILE", options->estimates, "CSV file for the estimates");
  command.add_option("--parameters=FILE", options->parameters,
                     "TOML file with parameters of the recommended estimator");
  add_followed_options(command, options->choice);
  add_pose_options(command, options->pose);
  add_cycle_options(command, options->cycles);
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
