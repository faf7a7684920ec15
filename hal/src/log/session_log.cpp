// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/log/session_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "log/index_file.h"
#include "log/session_format.h"
#include "log/session_log_state.h"

namespace condyle::hal {
namespace {

// Also writes the new file's entry in its folder to the disk.
void synchronise_folder(const std::string& path) {
  std::string folder = std::filesystem::path(path).parent_path().string();
  const int descriptor =
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // a folder that can be written but not read: nothing can be done
  static_cast<void>(fsync(descriptor));
  ::close(descriptor);
}

}  // namespace

const char* session_log_failure_name(SessionLogFailure failure) {
  constexpr const char* names[] = {
      "none",          "bad header",   "already exists",    "not found",
      "not permitted", "disk is full", "input/output error"};
  return names[static_cast<int>(failure)];
}

SessionLogWriter::SessionLogWriter(const SessionLogOptions& options) : options_(options) {
  options_.ring_reports = std::max<std::size_t>(options_.ring_reports, 1);
}

SessionLogWriter::~SessionLogWriter() {
  static_cast<void>(close());
}

SessionLogFailure SessionLogWriter::create(const std::string& path) {
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (descriptor_ < 0) {
    const int error = errno;
    fail(failure_of(error), error);
    return failure_;
  }
  if (write_pending() && synchronise_file()) {
    bytes_synchronised_ = bytes_written_.load();
    synchronise_folder(path);
    return SessionLogFailure::none;
  }
  ::close(descriptor_);
  descriptor_ = -1;
  static_cast<void>(unlink(path.c_str()));
  return failure_;
}

// What is lost while no log is open belongs to the one before, at first to the first.
void SessionLogWriter::forget() {
  has_failed_ = false;
  failure_.store(SessionLogFailure::none);
  system_error_ = 0;
  if (!std::exchange(was_opened_, true)) return;
  reports_written_ = events_written_ = bytes_written_ = chunks_written_ = bytes_synchronised_ = 0;
  reports_unwritten_ = events_unwritten_ = 0;
  for (const auto& source : sources_) {
    source->ring.clear();
    source->announced_lost = 0;
  }
}

bool SessionLogWriter::take_memory(const SessionHeader& header) {
  if (!header_problem(header).empty()) {
    fail(SessionLogFailure::bad_header, 0);
    return false;
  }
  if (sources_.size() != header.sources.size()) {
    sources_.clear();
    is_prepared_ = false;
  }
  while (sources_.size() < header.sources.size()) {
    sources_.push_back(std::make_unique<Source>(options_.ring_reports));
  }
  if (mcap_ == nullptr) mcap_ = std::make_unique<McapWriter>(McapHeader());
  try {
    if (writing_ == nullptr) writing_ = std::make_unique<Worker>();
    if (synchronising_ == nullptr) synchronising_ = std::make_unique<Worker>();
    return true;
  } catch (const std::system_error& error) {
    fail(SessionLogFailure::io_error, error.code().value());
    return false;
  }
}

SessionLogFailure SessionLogWriter::prepare(const SessionHeader& header) {
  if (descriptor_ >= 0) return SessionLogFailure::already_exists;
  if (!take_memory(header)) return failure_;
  if (std::exchange(is_prepared_, true)) return SessionLogFailure::none;
  add_header(header);
  rehearse();
  writing_->begin([this] { rehearse(); });  // takes no more, but uses the thread's stack
  writing_->wait();
  return SessionLogFailure::none;
}

// A chunk larger than any, most of it the smallest messages, and the end of a file. Nothing is
// written.
void SessionLogWriter::rehearse() {
  RawReport report;
  const auto add = [&](std::size_t size) {
    report.size = static_cast<std::uint16_t>(size);
    encode_report(report, message_);
    mcap_->add_message(report_channel(0), 0, message_);
  };
  while (mcap_->chunk_size() < kFullChunkBytes) add(1);
  // The last entry of a chunk may come with an event that tells of lost ones.
  add(kMaxReportSize);
  add(kMaxReportSize);
  static_cast<void>(mcap_->finish([] { return true; }));
  mcap_->discard_pending();
}

SessionLogFailure SessionLogWriter::open(const std::string& path, const SessionHeader& header) {
  if (descriptor_ >= 0) return SessionLogFailure::already_exists;
  forget();
  if (!take_memory(header)) return failure_;
  start_wall_ns_ = header.start_wall_ns;
  start_monotonic_ns_ = header.start_monotonic_ns;
  index_ = std::make_unique<IndexFile>(path);
  add_header(header);
  for (const auto& source : sources_) source->last_time_ns = header.start_monotonic_ns;
  learned_.clear();
  stops_ = is_complete_ = false;
  if (create(path) != SessionLogFailure::none) {
    index_.reset();
    return failure_;
  }
  synchronising_->begin([this] { synchronise(); });
  writing_->begin([this] { run(); });
  is_open_ = true;
  return SessionLogFailure::none;
}

void SessionLogWriter::add_header(const SessionHeader& header) {
  const std::string library = "condyle " + header.software_version;
  mcap_->begin_file({.profile = "", .library = library}, index_.get());
  mcap_->add_metadata({.name = kSessionMetadata, .pairs = session_pairs(header)});
  const auto attach = [&](std::string_view name, std::string_view media_type, ByteSpan data) {
    mcap_->add_attachment({.log_time_ns = static_cast<std::uint64_t>(header.start_wall_ns),
                           .name = name,
                           .media_type = media_type,
                           .data = data});
  };
  attach(kParametersName, "application/toml", bytes_of(header.parameters_toml));
  for (std::size_t i = 0; i < header.sources.size(); ++i) {
    const SessionSource& source = header.sources[i];
    attach(profile_name(i), "application/toml", bytes_of(source.profile_toml));
    attach(descriptor_name(i), "application/octet-stream", source.report_descriptor);
  }
  if (!header.begun_with_json.empty()) {
    attach(kBegunWithName, "application/json", bytes_of(header.begun_with_json));
  }
  const auto add_schema = [&](std::string_view name, std::string_view text) {
    return mcap_->add_schema({.name = name, .encoding = "ros2msg", .data = bytes_of(text)});
  };
  const std::uint16_t report_schema = add_schema(kReportSchemaName, kReportSchema);
  const std::uint16_t event_schema = add_schema(kEventSchemaName, kEventSchema);
  for (std::size_t i = 0; i < header.sources.size(); ++i) {
    const McapPairs name = {{"source", header.sources[i].name}};
    const std::string report = report_topic(i), event = event_topic(i);
    mcap_->add_channel(
        {.schema_id = report_schema, .topic = report, .message_encoding = "cdr", .metadata = name});
    mcap_->add_channel(
        {.schema_id = event_schema, .topic = event, .message_encoding = "cdr", .metadata = name});
  }
}

bool SessionLogWriter::write(std::size_t source_index, const RawReport& report) {
  RingSlot* slot = nullptr;
  if (!is_open_.load(std::memory_order_acquire) || source_index >= sources_.size() ||
      report.size > kMaxReportSize) {
    ++reports_unwritten_;
    return false;
  }
  ReportRing& ring = sources_[source_index]->ring;
  slot = ring.reserve(false);
  if (slot == nullptr) return false;
  slot->event = 0;
  slot->report.host_time_ns = report.host_time_ns;
  slot->report.size = report.size;
  std::copy_n(report.bytes.begin(), report.size, slot->report.bytes.begin());
  ring.publish();
  return true;
}

bool SessionLogWriter::write_event(std::size_t source_index, TimeNs time_ns, SessionEvent kind,
                                   std::string_view text, std::uint64_t count) {
  const bool is_known = kind >= SessionEvent::connected && kind <= SessionEvent::note;
  if (!is_open_.load(std::memory_order_acquire) || source_index >= sources_.size() || !is_known) {
    ++events_unwritten_;
    return false;
  }
  ReportRing& ring = sources_[source_index]->ring;
  RingSlot* const slot = ring.reserve(true);
  if (slot == nullptr) return false;
  const bool is_cut = text.size() > kMaxEventText;
  const std::size_t size = is_cut ? kMaxEventText - 3 : text.size();
  slot->event = static_cast<std::uint8_t>(kind);
  slot->count = count;
  slot->report.host_time_ns = time_ns;
  const auto end = std::copy_n(text.begin(), size, slot->report.bytes.begin());
  if (is_cut) std::fill_n(end, 3, '.');
  slot->report.size = static_cast<std::uint16_t>(is_cut ? kMaxEventText : size);
  ring.publish();
  return true;
}

bool SessionLogWriter::keep_learned(std::string text) {
  if (!is_open_.load(std::memory_order_acquire) || text.size() > kMaxTextBytes) return false;
  const std::lock_guard<std::mutex> lock(mutex_);
  learned_ = std::move(text);
  return true;
}

SessionLogStatus SessionLogWriter::status() const {
  SessionLogStatus status;
  status.failure = failure_;
  status.system_error = system_error_;
  status.reports_written = reports_written_;
  status.events_written = events_written_;
  status.bytes_written = bytes_written_;
  status.bytes_synchronised = bytes_synchronised_;
  status.chunks_written = chunks_written_;
  status.reports_lost = reports_unwritten_;
  status.events_lost = events_unwritten_;
  for (const auto& source : sources_) {
    status.reports_lost += source->ring.lost_reports();
    status.events_lost += source->ring.lost_events();
  }
  return status;
}

SessionLogFailure SessionLogWriter::close() {
  is_open_.store(false, std::memory_order_release);
  if (descriptor_ < 0) return failure_;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stops_ = true;
  }
  wake_.notify_one();
  writing_->wait();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_complete_ = true;
  }
  written_.notify_one();
  synchronising_->wait();
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(SessionLogFailure::io_error, errno);
  index_.reset();
  return failure_;
}

}  // namespace condyle::hal
