// SPDX-License-Identifier: Apache-2.0
#include "box/recording/session_recorder.h"

#include <fmt/format.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <utility>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"

namespace condyle::box {
namespace {

constexpr TimeNs kPause_ns = 5 * kNanosecondsPerSecond;
// Longest wait for a companion to open.
constexpr TimeNs kOpening_ns = kNanosecondsPerSecond;
constexpr TimeNs kPerStart_ns = 10 * kNanosecondsPerSecond;
constexpr TimeNs kMostStarts = 30;  // at once
constexpr TimeNs kLongestPart_ns = 6 * 3600 * kNanosecondsPerSecond;

int http_status(hal::SessionLogFailure failure) {
  return failure == hal::SessionLogFailure::disk_full ? 507 : 500;
}

std::string file_stem(const std::string& subject) {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &parts);
  return subject.empty() ? text : std::string(text) + "-" + subject;
}

// True only if its folder exists: a missing folder may come back, with the file in it.
bool is_gone(const std::string& file, const std::string& folder) {
  std::error_code error;
  struct statvfs status {};
  return std::filesystem::symlink_status(file, error).type() ==
             std::filesystem::file_type::not_found &&
         statvfs(folder.c_str(), &status) == 0;
}

}  // namespace

// A file of the session, and what is recorded in it.
struct SessionRecorder::Part {
  explicit Part(hal::SessionLogWriter& writer) : log(writer) {}
  ~Part() { (void)close(); }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  hal::SessionLogFailure close() {
    for (const auto& companion : companions) companion->companion.stop();
    return log.close();
  }
  hal::SessionLogWriter& log;
  std::size_t marker_source = 0;
  std::vector<std::unique_ptr<host::RecordedCompanion>> companions;
  std::vector<bool> were_there;
  TimeNs begin_ns = 0;
};

SessionRecorder::SessionRecorder(const Configuration& configuration,
                                 const host::ConfiguredFacebow& facebow, hal::Clock& clock,
                                 BoxLog& log, std::function<TimeNs()> wall_ns)
    : configuration_(configuration),
      facebow_(facebow),
      clock_(clock),
      box_log_(log),
      wall_ns_(std::move(wall_ns)),
      logs_{hal::SessionLogWriter(configuration.log), hal::SessionLogWriter(configuration.log)} {
  for (const SourceSettings& settings : configuration.companions) {
    companions_.push_back(host::make_session_device(settings.file, settings.serial,
                                                    host::backend_of(settings.kind), clock));
    if (facebow.device() != nullptr)
      host::reject_duplicate_devices(*facebow.device(), companions_.back());
  }
  host::reject_duplicate_devices(companions_);
  if (!configuration.folder.empty() && !std::filesystem::is_directory(configuration.folder)) {
    throw host::InputError(configuration.folder, "is not a folder",
                           "create it, or set another [recording] folder");
  }
}

SessionRecorder::~SessionRecorder() {
  (void)end_part();
}

void SessionRecorder::attach(Engine& engine) {
  engine_ = &engine;
}

SessionRecorder::Answer SessionRecorder::start(const std::string& subject) {
  if (configuration_.folder.empty()) {
    return {409, "recording is off; set [recording] folder in the box's configuration"};
  }
  if (!hal::is_subject_code(subject)) {
    return {400, "the subject must be a pseudonym of at most 32 letters, digits, - and _"};
  }
  if (state_.phase != SessionState::Phase::idle)
    return {409, "a session is being recorded; stop it first"};
  if (engine_ == nullptr) return {503, "the facebow has not been found yet"};
  if (wall_ns_() < 0) {
    return {503, "this machine's clock is before 1970; set it, then start again"};
  }
  const TimeNs starts_ns = std::max(starts_free_ns_, clock_.now_ns()) + kPerStart_ns;
  if (starts_ns > clock_.now_ns() + kMostStarts * kPerStart_ns) {
    return {429, "sessions begin too often; wait ten seconds, then start again"};
  }
  state_ = {};
  state_.subject = subject;
  stem_ = file_stem(subject);
  Answer answer = describe_companions();
  if (answer.status == 200) {
    const hal::SessionHeader facts = header();
    for (hal::SessionLogWriter& log : logs_) (void)log.prepare(facts);
    answer = begin_part();  // states what is wrong
  }
  if (answer.status != 200) {
    state_.problem = answer.words;
    return answer;
  }
  starts_free_ns_ = starts_ns;
  box_log_.say(BoxLog::Level::notice, "session", "recording " + state_.file);
  return answer;
}

hal::SessionHeader SessionRecorder::header() const {
  hal::SessionHeader header;
  header.software_version = "condyle " CONDYLE_VERSION;
  header.subject_code = state_.subject;
  header.parameters_toml = configuration_.parameters_toml;
  header.start_monotonic_ns = clock_.now_ns();
  header.start_wall_ns = wall_ns_();
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

// A missing companion would otherwise be noticed only after the session.
SessionRecorder::Answer SessionRecorder::describe_companions() {
  for (host::SessionDevice& companion : companions_) {
    try {
      host::probe_device(companion, [] { return true; });
    } catch (const host::InputError& error) {
      return {503, error.what()};
    }
  }
  return {};
}

// Two sessions may begin in the same second, or the wall clock may have been set back. The name of
// a dangling link counts as taken.
SessionRecorder::Answer SessionRecorder::find_free_name() const {
  for (int number = state_.part + 1;; ++number) {
    const std::filesystem::path file =
        std::filesystem::path(configuration_.folder) /
        (number == 1 ? stem_ + ".mcap" : fmt::format("{}-{}.mcap", stem_, number));
    std::error_code error;
    const auto type = std::filesystem::symlink_status(file, error).type();
    if (type == std::filesystem::file_type::not_found) return {200, file.string()};
    if (error) return {500, configuration_.folder + ": " + error.message()};
  }
}

SessionRecorder::Answer SessionRecorder::begin_part() {
  if (Answer room = find_room(); room.status != 200) return room;
  auto part = std::make_unique<Part>(logs_[part_ && &part_->log == &logs_[0] ? 1 : 0]);
  const Answer name = find_free_name();
  if (name.status != 200) return name;
  const std::string& file = name.words;
  const hal::SessionHeader facts = header();
  const hal::SessionLogFailure failure = part->log.open(file, facts);
  if (failure == hal::SessionLogFailure::bad_header) return {500, hal::header_problem(facts)};
  if (failure != hal::SessionLogFailure::none) {
    return {http_status(failure), file + ": " + hal::session_log_failure_name(failure)};
  }
  // No device is opened twice.
  if (part_) {
    for (const auto& companion : part_->companions) companion->companion.stop();
  }
  try {
    for (std::size_t i = 0; i < companions_.size(); ++i) {
      part->companions.push_back(
          std::make_unique<host::RecordedCompanion>(companions_[i], part->log, i + 1, clock_));
      part->companions.back()->companion.start();
      part->were_there.push_back(true);
    }
  } catch (const std::exception& error) {
    return {500, error.what()};
  }
  part->begin_ns = clock_.now_ns();
  part->marker_source = companions_.size() + 1;
  // The reports go from the old file to the new one without a gap.
  begin_run(&part->log);
  const std::unique_ptr<Part> old = std::exchange(part_, std::move(part));
  state_.problem.clear();
  if (old) (void)close_part(*old);
  state_.phase = SessionState::Phase::recording;
  state_.file = file;
  ++state_.part;
  return {200, file};
}

// Reports of the ending run belong to the state of the session up to here, and what it has learned
// to the part that ends.
void SessionRecorder::begin_run(hal::SessionLogWriter* log) {
  engine_->begin_run(log);
  const auto& learned = engine_->learned_before_run();
  if (part_ && learned && !part_->log.keep_learned(host::learned_text(*learned))) {
    box_log_.say(BoxLog::Level::warning, "session", state_.file + " lacks what was learned");
  }
  const std::uint64_t before = std::exchange(received_before_run_, engine_->received_before_run());
  const std::uint64_t received = received_before_run_ - before;
  if (state_.phase != SessionState::Phase::idle) state_.reports_received += received;
  if (state_.phase == SessionState::Phase::paused) state_.reports_in_pauses += received;
}

hal::SessionLogFailure SessionRecorder::end_part() {
  if (!part_) return hal::SessionLogFailure::none;
  begin_run(nullptr);
  const std::unique_ptr<Part> part = std::move(part_);
  return close_part(*part);
}

hal::SessionLogFailure SessionRecorder::close_part(Part& part) {
  const hal::SessionLogFailure failure = part.close();
  const hal::SessionLogStatus& log = state_.log = part.log.status();
  // A file deleted meanwhile does not count as recorded.
  const bool is_lost = is_gone(state_.file, configuration_.folder);
  (is_lost ? state_.reports_lost : state_.reports_written) += log.reports_written;
  state_.reports_lost += log.reports_lost;
  if (is_lost) {
    box_log_.say(
        BoxLog::Level::error, "session",
        fmt::format("{} has disappeared, with {} reports in it", state_.file, log.reports_written));
  }
  state_.events_written += log.events_written;
  state_.events_lost += log.events_lost;
  if (failure != hal::SessionLogFailure::none) {
    state_.problem = state_.file + ": " + hal::session_log_failure_name(failure) +
                     "; everything written before is intact";
    box_log_.say(BoxLog::Level::error, "session", state_.problem);
  }
  return failure;
}

SessionRecorder::Answer SessionRecorder::stop() {
  if (state_.phase == SessionState::Phase::idle) return {409, "no session is being recorded"};
  if (state_.phase == SessionState::Phase::paused) {
    begin_run(nullptr);
    state_.paused_ns += clock_.now_ns() - paused_since_ns_;
    state_.problem = "ended while " + state_.problem;
  }
  const hal::SessionLogFailure failure = end_part();
  state_.phase = SessionState::Phase::idle;
  box_log_.say(
      BoxLog::Level::notice, "session",
      fmt::format("ended {}: {} reports, {} lost, {} in {:.0f} s of pauses, {} received",
                  state_.file, state_.reports_written, state_.reports_lost,
                  state_.reports_in_pauses, seconds(state_.paused_ns), state_.reports_received));
  if (failure != hal::SessionLogFailure::none) return {http_status(failure), state_.problem};
  return {200, state_.file};
}

SessionRecorder::Answer SessionRecorder::mark(const std::string& text) {
  if (text.empty() || text.size() > hal::kMaxEventText) {
    return {400, fmt::format("a marker must have 1 to {} bytes of text", hal::kMaxEventText)};
  }
  if (host::clean_line(text) != text) {
    return {400, "a marker must be one line of UTF-8 without control characters"};
  }
  if (state_.phase == SessionState::Phase::paused) return {409, state_.problem};
  if (!part_) return {409, "no session is being recorded"};
  if (!part_->log.write_event(part_->marker_source, clock_.now_ns(), hal::SessionEvent::note,
                              text)) {
    return {503, "the recording has no room for a marker now; try again"};
  }
  ++state_.markers;
  return {200, fmt::format("marker {}", state_.markers)};
}

void SessionRecorder::pause(const std::string& why) {
  (void)end_part();
  paused_since_ns_ = clock_.now_ns();
  state_.phase = SessionState::Phase::paused;
  ++state_.pauses;
  state_.problem = "recording is paused: " + why;
  next_attempt_ns_ = clock_.now_ns() + kPause_ns;
  box_log_.say(BoxLog::Level::error, "session", state_.problem);
}

void SessionRecorder::check() {
  if (part_) {
    const hal::SessionLogStatus log = part_->log.status();
    if (log.failure != hal::SessionLogFailure::none) {
      pause(state_.file + ": " + hal::session_log_failure_name(log.failure));
    } else if (const Answer room = find_room(); room.status != 200) {
      pause(room.words);
    } else if (clock_.now_ns() - part_->begin_ns >= kLongestPart_ns ||
               is_gone(state_.file, configuration_.folder)) {
      const Answer answer = begin_part();
      if (answer.status != 200) pause(answer.words);
    }
  } else if (state_.phase == SessionState::Phase::paused && clock_.now_ns() >= next_attempt_ns_) {
    next_attempt_ns_ = clock_.now_ns() + kPause_ns;
    const Answer answer = begin_part();
    if (answer.status == 200) {
      state_.paused_ns += clock_.now_ns() - paused_since_ns_;
      box_log_.say(BoxLog::Level::notice, "session", "recording continues in " + state_.file);
    } else {
      state_.problem = "recording is paused: " + answer.words;
    }
  }
  watch_companions();
}

void SessionRecorder::watch_companions() {
  if (!part_ || clock_.now_ns() - part_->begin_ns < kOpening_ns) return;
  for (std::size_t i = 0; i < part_->companions.size(); ++i) {
    const bool is_there = part_->companions[i]->companion.is_open();
    if (is_there == part_->were_there[i]) continue;
    part_->were_there[i] = is_there;
    box_log_.say(is_there ? BoxLog::Level::notice : BoxLog::Level::warning, "companion",
                 configuration_.companions[i].name +
                     (is_there ? " is connected again" : " was disconnected; looking for it"));
  }
}

SessionRecorder::Answer SessionRecorder::find_room() const {
  struct statvfs status {};
  if (statvfs(configuration_.folder.c_str(), &status) != 0) {
    return {500, configuration_.folder + ": " + std::strerror(errno)};
  }
  if (free_bytes() >= configuration_.reserve_bytes) return {};
  return {507, fmt::format("the disk has less than {:.0f} MB left",
                           static_cast<double>(configuration_.reserve_bytes) * 1e-6)};
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
  SessionState state = state_;
  if (part_) {
    state.log = part_->log.status();
    state.reports_written += state.log.reports_written;
    state.reports_lost += state.log.reports_lost;
    state.events_written += state.log.events_written;
    state.events_lost += state.log.events_lost;
    for (std::size_t i = 0; i < part_->companions.size(); ++i) {
      state.companions.push_back(
          {configuration_.companions[i].name, part_->companions[i]->companion.is_open()});
    }
  }
  if (engine_ != nullptr && state.phase != SessionState::Phase::idle) {
    const std::uint64_t received = engine_->counts().received;
    state.reports_received += std::max(received, received_before_run_) - received_before_run_;
  }
  state.free_bytes = free_bytes();
  return state;
}

}  // namespace condyle::box
