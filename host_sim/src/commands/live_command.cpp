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
#include "options/stream_options.h"
#include "readings/landmarks.h"
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
  lsl::StreamChoice stream;
  std::string lsl_out;
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
box::SourceSettings played(box::SourceSettings source, std::optional<PlayedFolder>& folder) {
  if (source.stream || source.kind != SourceKind::file || is_session_log(source.file)) {
    return source;
  }
  folder.emplace();
  write_as_session_log(source.file, folder->log(), stop_requested);
  source.file = folder->log();
  return source;
}

box::SourceSettings parse_live_source(const LiveOptions& options) {
  auto stream = parse_stream(options.source);
  refuse_without_stream(options.stream, stream.has_value());
  const SourceSpec spec = stream ? SourceSpec() : source_of(options.source);
  if (stream ? stream->place.empty() : spec.file.empty()) {
    throw InputError(options.source, "does not name a file or stream", "write it after the colon");
  }
  if (spec.kind == SourceKind::sim) {
    throw InputError(options.source, "a simulated subject does not send reports",
                     "write synth:PROFILE for a jaw that chews, or file:RECORDING for a recording");
  }
  if (stream) stream->choice = options.stream;
  return {"facebow", spec.kind, spec.file, options.serial, stream};
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

box::JawPlaces jaw_places(const Landmarks& landmarks) {
  const auto in_mm = [&landmarks](int point) {
    const Eigen::Vector3d place_mm = 1e3 * landmarks.point_m[static_cast<std::size_t>(point)];
    return box::JawPlaces::Vector{place_mm.x(), place_mm.y(), place_mm.z()};
  };
  box::JawPlaces places{in_mm(Landmarks::condyle_left),
                        in_mm(Landmarks::condyle_right),
                        in_mm(Landmarks::incisor_lower),
                        {}};
  const Eigen::Matrix3d axes = head_frame(landmarks).linear();
  for (int i = 0; i < 3; ++i) {
    places.axes[static_cast<std::size_t>(i)] = {axes(0, i), axes(1, i), axes(2, i)};
  }
  return places;
}

box::Configuration configuration_of(const LiveOptions& options, const box::SourceSettings& source,
                                    SampleKind kind,
                                    const std::shared_ptr<std::atomic<int>>& reports) {
  box::Configuration configuration;
  configuration.facebow = source;
  configuration.followed = options.choice.followed;
  if (kind == SampleKind::three_points || kind == SampleKind::pose) {
    PoseOptions pose;
    pose.point_words = options.jaw_points;
    configuration.pose = pose.choice();
  } else if (!options.jaw_points.empty()) {
    refuse_without_pose("--pose-point: the facebow", kind, "leave it out");
  }
  if (!options.landmarks.empty()) configuration.jaw = jaw_places(load_landmarks(options.landmarks));
  if (!options.parameters.empty()) {
    configuration.parameters_toml = read_text_file(options.parameters);
    configuration.parameters =
        parse_recommended_parameters(options.parameters, configuration.parameters_toml);
  }
  configuration.lsl_out = options.lsl_out;
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
  const box::SourceSettings named = parse_live_source(options);
  if (!options.lsl_out.empty()) lsl::check_outlet_place(options.lsl_out);
  std::optional<PlayedFolder> played_folder;
  const box::SourceSettings source = played(named, played_folder);
  hal::SteadyClock clock;
  const SampleKind kind = box::configured(source, clock).profile().kind;
  options.choice.check(options.source, kind);
  const auto reports = std::make_shared<std::atomic<int>>(0);
  const box::Configuration configuration = configuration_of(options, source, kind, reports);
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
                  "recording; synth:PROFILE, a jaw that chews; lsl:NAME, a stream of the Lab "
                  "Streaming Layer")
      .required();
  command.add_option("--port", options->port, "Port of the page on 127.0.0.1; 0: any free one")
      .within(0, kHighestPort)
      .show_default();
  command.add_option("--sessions=FOLDER", options->sessions, "Folder for the recorded sessions")
      .show_default();
  add_stream_options(command, options->stream);
  add_stream_outlet_option(command, options->lsl_out);
  command.add_option("--serial", options->serial, "Serial number, if several are plugged in");
  command.add_option("--parameters=FILE", options->parameters,
                     "TOML file with parameters of the recommended estimator");
  command.add_option("--landmarks=FILE", options->landmarks,
                     "TOML file of landmarks, for the drawn jaw and the reports of sessions");
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
