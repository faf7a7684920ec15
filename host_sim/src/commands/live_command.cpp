// SPDX-License-Identifier: Apache-2.0
// The live page on this computer, by the service of the measurement box.
#include <fmt/format.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>

#include "box/configuration.h"
#include "box/service/box.h"
#include "commands/commands.h"
#include "hosted/config/parameter_file.h"
#include "hosted/devices/configured_facebow.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "recordings/played_recording.h"
#include "report/report_page.h"

namespace condyle::host {
namespace {

constexpr int kHighestPort = 65'535;

struct LiveOptions {
  std::string source, serial, parameters, landmarks;
  std::string sessions = "sessions";
  std::vector<std::string> jaw_points;
  FollowedChoice choice;
  int port = 0;
  double duration_s = 0;
};

// Makes the folder of the sessions, and removes it again if nothing was recorded.
class SessionsFolder {
 public:
  explicit SessionsFolder(const std::string& path) : path_(path) {
    std::error_code error;
    is_new_ = std::filesystem::create_directories(path, error);
    if (!std::filesystem::is_directory(path)) {
      throw InputError("--sessions " + path, error ? error.message() : "is not a folder",
                       "name a folder that you may write to");
    }
  }
  ~SessionsFolder() {
    std::error_code ignored;
    if (is_new_) std::filesystem::remove(path_, ignored);  // only if it is empty
  }
  SessionsFolder(const SessionsFolder&) = delete;
  SessionsFolder& operator=(const SessionsFolder&) = delete;

 private:
  std::string path_;
  bool is_new_ = false;
};

// A folder for what is played, until the command ends.
class PlayedFolder {
 public:
  PlayedFolder() {
    std::error_code error;
    path_ = std::filesystem::temp_directory_path(error) / "condyle-live-XXXXXX";
    if (error || mkdtemp(path_.data()) == nullptr) {
      throw InputError(path_, "cannot be made", "name a folder that you may write to in TMPDIR");
    }
  }
  ~PlayedFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PlayedFolder(const PlayedFolder&) = delete;
  PlayedFolder& operator=(const PlayedFolder&) = delete;
  std::string log() const { return path_ + "/played.mcap"; }

 private:
  std::string path_;
};

// Another recording than a session log is played from a log of the same samples in `folder`.
SourceSpec played(const SourceSpec& spec, std::optional<PlayedFolder>& folder) {
  if (spec.kind != SourceKind::file || is_session_log(spec.file)) return spec;
  folder.emplace();
  write_as_session_log(spec.file, folder->log(), stop_requested);
  SourceSpec log = spec;
  log.file = folder->log();
  return log;
}

SourceSpec parse_live_source(const std::string& text) {
  const SourceSpec spec = source_of(text);
  if (spec.file.empty()) {
    throw InputError(text, "does not name a file", "write the file after the colon");
  }
  if (spec.kind == SourceKind::sim) {
    throw InputError(text, "a simulated subject does not send reports",
                     "write synth:PROFILE for a jaw that chews, or file:RECORDING for a recording");
  }
  return spec;
}

// Counts the reports that threads of their own are making.
class ReportUnderWay {
 public:
  explicit ReportUnderWay(std::atomic<int>& count) : count_(count) { ++count_; }
  ~ReportUnderWay() { --count_; }
  ReportUnderWay(const ReportUnderWay&) = delete;
  ReportUnderWay& operator=(const ReportUnderWay&) = delete;

 private:
  std::atomic<int>& count_;
};

std::string make_report(const std::string& log, const std::string& landmarks) {
  ReportChoice choice;
  choice.analysis.landmarks = landmarks;
  return report_page({report_section(
                         log, choice, [](double) {}, stop_requested)},
                     landmarks, nullptr);
}

box::Configuration configuration_of(const LiveOptions& options, const SourceSpec& spec,
                                    SampleKind kind,
                                    const std::shared_ptr<std::atomic<int>>& reports) {
  box::Configuration configuration;
  configuration.facebow = {"facebow", spec.kind, spec.file, options.serial};
  configuration.followed = options.choice.followed;
  if (kind == SampleKind::three_points || kind == SampleKind::pose) {
    PoseOptions pose;
    pose.point_words = options.jaw_points;
    configuration.pose = pose.choice();
  } else if (!options.jaw_points.empty()) {
    refuse_without_pose("--pose-point: the facebow", kind, "leave it out");
  }
  if (!options.parameters.empty()) {
    configuration.parameters_toml = read_text_file(options.parameters);
    configuration.parameters =
        parse_recommended_parameters(options.parameters, configuration.parameters_toml);
  }
  configuration.folder = options.sessions;
  configuration.http_port = static_cast<std::uint16_t>(options.port);
  configuration.priority = 0;
  configuration.locks_memory = false;
  configuration.make_report = [landmarks = options.landmarks, reports](const std::string& log) {
    const ReportUnderWay under_way(*reports);
    return make_report(log, landmarks);
  };
  return configuration;
}

int show_live(const LiveOptions& options) {
  const SourceSpec named = parse_live_source(options.source);
  if (!options.landmarks.empty()) static_cast<void>(load_landmarks(options.landmarks));
  std::optional<PlayedFolder> played_folder;
  const SourceSpec spec = played(named, played_folder);
  hal::SteadyClock clock;
  const SampleKind kind = ConfiguredFacebow(spec, options.serial, clock).profile().kind;
  options.choice.check(options.source, kind);
  const auto reports = std::make_shared<std::atomic<int>>(0);
  const box::Configuration configuration = configuration_of(options, spec, kind, reports);
  const SessionsFolder folder(options.sessions);
  box::BoxLog log(clock, stderr, box::BoxLog::Reader::person);
  box::Box service(configuration, clock, log);
  print_output(
      fmt::format("http://127.0.0.1:{}/ shows {} until Ctrl-C; sessions go to {}\n"
                  "research use only; not a diagnosis\n",
                  service.http_port(), clean_line(options.source), clean_line(options.sessions)));
  const TimeNs begin_ns = clock.now_ns();
  service.run([&] {
    return stop_requested() ||
           (options.duration_s > 0 && seconds(clock.now_ns() - begin_ns) >= options.duration_s);
  });
  if (service.is_held_by_disk()) std::_Exit(kExitBadInput);
  if (*reports > 0) std::_Exit(kExitOk);  // their readers have gone
  return kExitOk;
}

}  // namespace

Command add_live(CommandLine app) {
  auto options = std::make_shared<LiveOptions>();
  const CommandLine command = app.add_command(
      "live", "Show a facebow in the browser as it moves; Ctrl-C ends it", "Measure with a device");
  command.add_example("condyle live hid:bow.toml", "Open the printed address in a browser.");
  command.add_example("condyle live file:session.mcap --port 8080",
                      "Play a recording at its recorded speed.");
  command
      .add_option("SOURCE", options->source,
                  "hid:PROFILE or usb:PROFILE, a device; file:RECORDING, a session log or another "
                  "recording; synth:PROFILE, a jaw that chews")
      .required();
  command.add_option("--port", options->port, "Port of the page on 127.0.0.1; 0: any free one")
      .within(0, kHighestPort)
      .show_default();
  command.add_option("--sessions=FOLDER", options->sessions, "Folder for the recorded sessions")
      .show_default();
  command.add_option("--serial", options->serial, "Serial number, if several are plugged in");
  command.add_option("--parameters=FILE", options->parameters,
                     "TOML file with parameters of the recommended estimator");
  command.add_option("--landmarks=FILE", options->landmarks,
                     "TOML file of landmarks for the reports of sessions");
  command
      .add_option("--pose-point", options->jaw_points,
                  "NAME X Y Z (mm): a point fixed to the jaw, in its frame; repeatable. "
                  "condyle_left, condyle_right and incisor give the drawn jaw its size")
      .values_each(4);
  add_followed_options(command, options->choice, JawPoints::no);
  command.add_option("--duration-s", options->duration_s, "End after this time; 0: never")
      .number_in({0, 1e7})
      .show_default();
  return [options] { return show_live(*options); };
}

}  // namespace condyle::host
