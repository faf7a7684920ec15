// SPDX-License-Identifier: Apache-2.0
#include "box/session_recorder.h"

#include <fmt/format.h>
#include <sys/statvfs.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <utility>

#include "input_error.h"

namespace condyle::box {
namespace {

constexpr TimeNs kPause_ns = 5 * kNanosecondsPerSecond;

TimeNs wall_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string file_stem(const std::string& subject) {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &parts);
  return subject.empty() ? text : std::string(text) + "-" + subject;
}

}  // namespace

// A file of the session, and who writes into it.
struct SessionRecorder::Part {
  hal::SessionLogWriter log;
  std::size_t marker_source = 0;
  std::vector<std::unique_ptr<host::RecordedCompanion>> companions;
};

SessionRecorder::SessionRecorder(const Configuration& configuration, const FacebowReports& facebow,
                                 hal::Clock& clock, BoxLog& log)
    : configuration_(configuration), facebow_(facebow), clock_(clock), box_log_(log) {
  for (const SourceSettings& settings : configuration.companions) {
    companions_.push_back(
        host::name_device(settings.file, settings.serial,
                          settings.kind == SourceSettings::Kind::usb ? "libusb" : "hidapi", clock));
    if (facebow.device() != nullptr) host::refuse_twins(*facebow.device(), companions_.back());
  }
  host::refuse_twins(companions_);
  if (!configuration.folder.empty() && !std::filesystem::is_directory(configuration.folder)) {
    throw host::InputError(configuration.folder, "is no folder to record into",
                           "make it, or name another as [recording] folder");
  }
}

SessionRecorder::~SessionRecorder() {
  const std::lock_guard lock(mutex_);
  end_part();
}

void SessionRecorder::attach(Engine& engine) {
  const std::lock_guard lock(mutex_);
  engine_ = &engine;
}

SessionRecorder::Answer SessionRecorder::start(const std::string& subject) {
  const std::lock_guard lock(mutex_);
  if (configuration_.folder.empty()) {
    return {409, "this box records nothing; name a [recording] folder in its configuration"};
  }
  if (!hal::is_subject_code(subject)) {
    return {400, "the subject is a pseudonym of at most 32 letters, digits, - and _"};
  }
  if (state_.phase != SessionState::Phase::idle)
    return {409, "a session is being recorded; stop it first"};
  if (engine_ == nullptr) return {503, "the facebow has not been found yet"};
  state_ = {};
  state_.subject = subject;
  stem_ = file_stem(subject);
  const Answer answer = begin_part();
  if (answer.status != 200) {
    state_.problem = answer.words;
    return answer;
  }
  box_log_.say(BoxLog::Level::notice, "session", "recording " + state_.file);
  return answer;
}

hal::SessionHeader SessionRecorder::header() const {
  hal::SessionHeader header;
  header.software_version = "condyle " CONDYLE_VERSION;
  header.subject_code = state_.subject;
  header.parameters_toml = configuration_.parameters_toml;
  header.start_monotonic_ns = clock_.now_ns();
  header.start_wall_ns = wall_ns();
  const hal::DeviceProfile& profile = facebow_.profile();
  header.sources.push_back({"facebow", profile.vendor_id, profile.product_id,
                            facebow_.profile_text(), facebow_.descriptor()});
  for (std::size_t i = 0; i < companions_.size(); ++i) {
    const host::SessionDevice& device = companions_[i];
    header.sources.push_back({configuration_.companions[i].name, device.profile.vendor_id,
                              device.profile.product_id, device.profile_text, device.descriptor});
  }
  header.sources.push_back({hal::kMarkerSource, 0, 0, "", {}});
  return header;
}

SessionRecorder::Answer SessionRecorder::begin_part() {
  if (free_bytes() < configuration_.reserve_bytes) {
    return {507, fmt::format("the disk has less than {:.0f} MB left",
                             static_cast<double>(configuration_.reserve_bytes) * 1e-6)};
  }
  auto part = std::make_unique<Part>();
  const int number = state_.part + 1;
  const std::string file =
      (std::filesystem::path(configuration_.folder) /
       (number == 1 ? stem_ + ".mcap" : fmt::format("{}-{}.mcap", stem_, number)))
          .string();
  const hal::SessionHeader facts = header();
  const hal::SessionLogFailure failure = part->log.open(file, facts);
  if (failure == hal::SessionLogFailure::bad_header) return {500, hal::header_problem(facts)};
  if (failure != hal::SessionLogFailure::none) {
    return {507, file + ": " + hal::session_log_failure_name(failure)};
  }
  for (std::size_t i = 0; i < companions_.size(); ++i) {
    part->companions.push_back(
        std::make_unique<host::RecordedCompanion>(companions_[i], part->log, i + 1, clock_));
    part->companions.back()->companion.start();
  }
  part->marker_source = companions_.size() + 1;
  part_ = std::move(part);
  state_.phase = SessionState::Phase::recording;
  state_.file = file;
  state_.part = number;
  state_.problem.clear();
  engine_->begin_run(&part_->log);
  return {200, file};
}

void SessionRecorder::end_part() {
  if (!part_) return;
  engine_->begin_run(nullptr);
  for (const auto& companion : part_->companions) companion->companion.stop();
  const hal::SessionLogFailure failure = part_->log.close();
  state_.log = part_->log.status();
  if (failure != hal::SessionLogFailure::none) {
    state_.problem = state_.file + ": " + hal::session_log_failure_name(failure) +
                     "; what reached the disk before is whole";
    box_log_.say(BoxLog::Level::error, "session", state_.problem);
  }
  part_.reset();
}

SessionRecorder::Answer SessionRecorder::stop() {
  const std::lock_guard lock(mutex_);
  if (state_.phase == SessionState::Phase::idle) return {409, "no session is being recorded"};
  end_part();
  state_.phase = SessionState::Phase::idle;
  box_log_.say(BoxLog::Level::notice, "session",
               fmt::format("ended {}: {} reports, {} lost", state_.file, state_.log.reports_written,
                           state_.log.reports_lost));
  return {200, state_.file};
}

SessionRecorder::Answer SessionRecorder::mark(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (text.empty() || text.size() > hal::kMaxEventText) {
    return {400, fmt::format("a marker has 1 to {} bytes of text", hal::kMaxEventText)};
  }
  if (!part_) return {409, "no session is being recorded"};
  if (!part_->log.write_event(part_->marker_source, clock_.now_ns(), hal::SessionEvent::note,
                              text)) {
    return {503, "the recording has no room for a marker just now"};
  }
  ++state_.markers;
  return {200, fmt::format("marker {}", state_.markers)};
}

void SessionRecorder::pause(const std::string& why) {
  end_part();
  state_.phase = SessionState::Phase::paused;
  ++state_.pauses;
  state_.problem = "recording is paused: " + why;
  next_attempt_ns_ = clock_.now_ns() + kPause_ns;
  box_log_.say(BoxLog::Level::error, "session", state_.problem);
}

void SessionRecorder::check() {
  const std::lock_guard lock(mutex_);
  if (part_) {
    const hal::SessionLogStatus log = part_->log.status();
    if (log.failure != hal::SessionLogFailure::none) {
      pause(state_.file + ": " + hal::session_log_failure_name(log.failure));
    } else if (free_bytes() < configuration_.reserve_bytes) {
      pause("the disk is as full as it may become");
    }
  } else if (state_.phase == SessionState::Phase::paused && clock_.now_ns() >= next_attempt_ns_) {
    next_attempt_ns_ = clock_.now_ns() + kPause_ns;
    const Answer answer = begin_part();
    if (answer.status == 200) {
      box_log_.say(BoxLog::Level::notice, "session", "recording goes on in " + state_.file);
    }
  }
}

std::uint64_t SessionRecorder::free_bytes() const {
  struct statvfs status {};
  if (configuration_.folder.empty() || statvfs(configuration_.folder.c_str(), &status) != 0) {
    return 0;
  }
  std::uint64_t bytes = status.f_bavail;
  bytes *= status.f_frsize;
  return bytes;
}

SessionState SessionRecorder::state() const {
  const std::lock_guard lock(mutex_);
  SessionState state = state_;
  if (part_) state.log = part_->log.status();
  state.free_bytes = free_bytes();
  return state;
}

}  // namespace condyle::box
