// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/log/session_log.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

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

SessionLogFailure SessionLogWriter::open(const std::string& path, const SessionHeader& header) {
  if (mcap_ != nullptr) return SessionLogFailure::already_exists;
  if (!header_problem(header).empty()) {
    fail(SessionLogFailure::bad_header, 0);
    return failure_;
  }
  start_wall_ns_ = header.start_wall_ns;
  start_monotonic_ns_ = header.start_monotonic_ns;
  index_ = std::make_unique<IndexFile>(path);
  add_header(header);
  for (std::size_t i = 0; i < header.sources.size(); ++i) {
    sources_.push_back(std::make_unique<Source>(options_.ring_reports));
    sources_.back()->last_time_ns = header.start_monotonic_ns;
  }
  if (create(path) != SessionLogFailure::none) return failure_;

  // Signals are for the program's own threads. The one for a file that is too large (SIGXFSZ) is
  // blocked, so that write() reports the error.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    synchroniser_ = std::thread(&SessionLogWriter::synchronise, this);
    thread_ = std::thread(&SessionLogWriter::run, this);
    is_open_ = true;
  } catch (const std::system_error& error) {
    fail(SessionLogFailure::io_error, error.code().value());
    end_synchroniser();
    ::close(descriptor_);
    descriptor_ = -1;
    static_cast<void>(unlink(path.c_str()));
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return failure_;
}

void SessionLogWriter::add_header(const SessionHeader& header) {
  mcap_ = std::make_unique<McapWriter>(
      McapHeader{.profile = "", .library = "condyle " + header.software_version}, index_.get());
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

void SessionLogWriter::end_synchroniser() {
  if (!synchroniser_.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_complete_ = true;
  }
  written_.notify_one();
  synchroniser_.join();
}

SessionLogFailure SessionLogWriter::close() {
  is_open_.store(false, std::memory_order_release);
  if (thread_.joinable()) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stops_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  end_synchroniser();
  if (descriptor_ >= 0) {
    if (::close(descriptor_) != 0) fail(SessionLogFailure::io_error, errno);
    descriptor_ = -1;
  }
  return failure_;
}

}  // namespace condyle::hal
