// SPDX-License-Identifier: Apache-2.0
// Records a session: raw reports and transport events of one or more devices, with everything
// needed to repeat the estimates. The file is MCAP, which Foxglove, PlotJuggler and @mcap/core can
// read.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/hal/log/mcap_writer.h"
#include "condyle/hal/report/raw_report.h"

namespace condyle::hal {

/// Most devices in one log.
inline constexpr std::size_t kMaxSessionSources = 8;
/// Longest text of an event in bytes; a longer one is cut and ends in "...".
inline constexpr std::size_t kMaxEventText = 512;

/// Name of the attachment with what the estimator has learned during the session, as JSON.
inline constexpr std::string_view kLearnedName = "learned.json";
/// Longest text in a log.
inline constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;

/// Name of a source that is not a device: its events are the session's markers. It has no profile.
inline constexpr const char* kMarkerSource = "markers";

/// A recorded device, or the session's markers.
struct SessionSource {
  std::string name;  ///< "facebow": letters, digits, - and _, 1 to 32 of them
  std::uint16_t vendor_id = 0, product_id = 0;
  std::string profile_toml;                     ///< how its reports are decoded
  std::vector<std::uint8_t> report_descriptor;  ///< as the device sent it; may be empty
};

/// False for the markers.
inline bool is_device(const SessionSource& source) {
  return !source.profile_toml.empty() || source.name != kMarkerSource;
}

/// The facts about a session in its log. They do not identify a person, a machine or a user.
struct SessionHeader {
  std::string software_version;
  std::string subject_code;  ///< pseudonym, see is_subject_code
  std::string parameters_toml;
  std::string begun_with_json;    ///< what its estimator began with (keep_learned); empty: nothing
  TimeNs start_wall_ns = 0;       ///< since 1970-01-01 UTC
  TimeNs start_monotonic_ns = 0;  ///< the same instant on the clock of the reports
  std::vector<SessionSource> sources;
};

/// True for "" (none given) and up to 32 of letters, digits, - and _.
bool is_subject_code(std::string_view code);

/// Why `header` cannot be recorded; empty if it can.
std::string header_problem(const SessionHeader& header);

/// Events of a device or of its recording.
enum class SessionEvent : std::uint8_t {
  connected = 1,
  disconnected,
  stall,           ///< endpoint halted, and cleared again
  transfer_error,  ///< a transfer failed otherwise
  oversized,       ///< a report longer than kMaxReportSize was dropped
  not_recorded,    ///< the recorder had no room: `count` reports and events are missing here
  note,            ///< anything else worth keeping
};

/// "connected", "stall", ...; "unknown" for other values.
const char* session_event_name(SessionEvent event);

/// Why recording stopped or could not begin.
enum class [[nodiscard]] SessionLogFailure : std::uint8_t{
    none,
    bad_header,      ///< see header_problem
    already_exists,  ///< a log is never overwritten
    not_found,       ///< the folder is not there
    not_permitted,
    disk_full,  ///< no space, quota or largest file size reached
    io_error,
};

/// "disk full", ...
const char* session_log_failure_name(SessionLogFailure failure);

/// Status of the recording. Once it is closed, every report and event that was given counts as
/// written or lost.
struct SessionLogStatus {
  SessionLogFailure failure = SessionLogFailure::none;
  int system_error = 0;               ///< errno of the failure
  std::uint64_t reports_written = 0;  ///< in the file
  std::uint64_t reports_lost = 0;     ///< no room in the ring, or the file failed
  std::uint64_t events_written = 0, events_lost = 0;
  std::uint64_t bytes_written = 0, chunks_written = 0;
  std::uint64_t bytes_synchronised = 0;  ///< safe on the disk
};

/// Sizes of the buffers.
struct SessionLogOptions {
  std::size_t ring_reports = 4096;     ///< in each source's ring: 8 s at 500 Hz, 4 MiB
  TimeNs chunk_time_ns = 200'000'000;  ///< from a chunk's first report to its writing
};

struct RingSlot;
class IndexFile;
class Worker;

/// Writes session logs, one after another in the same memory. One thread for each source calls
/// write and write_event; they only copy into a ring of fixed size. The writer's own thread
/// compresses and writes at least every 250 ms while reports arrive, which limits what a crash of
/// the program loses. Another thread synchronises (fdatasync) what was written as soon as the disk
/// allows, which limits what a crash of the machine loses.
class SessionLogWriter {
 public:
  explicit SessionLogWriter(const SessionLogOptions& options = {});
  ~SessionLogWriter();
  SessionLogWriter(const SessionLogWriter&) = delete;
  SessionLogWriter& operator=(const SessionLogWriter&) = delete;

  /// Takes the memory and threads for logs with `header`'s sources, and uses them once, so that
  /// opening and recording take next to none. Not while a log is open.
  SessionLogFailure prepare(const SessionHeader& header);

  /// Creates the file `path` (mode 0600, never an existing one) with the header in it. If it fails,
  /// it leaves no file. After close it may be called again; the status then begins anew.
  SessionLogFailure open(const std::string& path, const SessionHeader& header);

  /// Records `report`. False: it is lost, and counted. Never blocks or allocates.
  bool write(std::size_t source_index, const RawReport& report);
  /// Records that something happened `count` times by `time_ns` of the reports' clock. Works like
  /// write; some places of the ring are reserved for events.
  bool write_event(std::size_t source_index, TimeNs time_ns, SessionEvent kind,
                   std::string_view text, std::uint64_t count = 1);

  /// Keeps the JSON `text` until close, which writes it as the attachment kLearnedName. False, and
  /// nothing is kept, if it is longer than kMaxTextBytes. Only while a log is open.
  bool keep_learned(std::string text);

  /// The status; any thread may ask.
  SessionLogStatus status() const;

  /// Writes what is left and completes the file. No thread may be in write or write_event; later
  /// calls of them are lost and counted. May be called twice.
  SessionLogFailure close();

 private:
  struct Source;

  void forget();
  bool take_memory(const SessionHeader& header);
  void rehearse();
  SessionLogFailure create(const std::string& path);
  void add_header(const SessionHeader& header);
  void run();
  void drain();
  void add(std::size_t source_index, const RingSlot& slot);
  void add_event(std::size_t source_index, TimeNs time_ns, SessionEvent kind, std::uint64_t count,
                 std::string_view text);
  void announce_lost(std::size_t source_index, std::uint64_t lost_count, TimeNs time_ns);
  void flush();
  void add_learned();
  bool write_pending();
  void synchronise();
  bool synchronise_file();
  void fail(SessionLogFailure failure, int system_error);
  std::uint64_t log_time_ns(TimeNs time_ns) const;

  SessionLogOptions options_;
  std::vector<std::unique_ptr<Source>> sources_;
  std::unique_ptr<IndexFile> index_;
  std::unique_ptr<McapWriter> mcap_;
  int descriptor_ = -1;       // of the open log
  bool was_opened_ = false;   // ever
  bool is_prepared_ = false;  // for as many sources as there are
  TimeNs start_wall_ns_ = 0, start_monotonic_ns_ = 0;

  // The writing thread's own, as are mcap_ and descriptor_ while it runs.
  std::vector<std::uint8_t> message_;
  std::uint64_t chunk_reports_ = 0, chunk_events_ = 0;
  TimeNs chunk_begin_ns_ = 0;

  std::unique_ptr<Worker> writing_, synchronising_;
  std::mutex mutex_;
  std::condition_variable wake_, written_;
  bool stops_ = false, is_complete_ = false;  // guarded by mutex_
  std::string learned_;                       // guarded by mutex_

  std::atomic<bool> is_open_ = false, has_failed_ = false;
  std::atomic<SessionLogFailure> failure_ = SessionLogFailure::none;
  std::atomic<int> system_error_ = 0;
  std::atomic<std::uint64_t> reports_written_ = 0, events_written_ = 0, bytes_written_ = 0,
                             chunks_written_ = 0, bytes_synchronised_ = 0;
  // Lost for other reasons than a full ring.
  std::atomic<std::uint64_t> reports_unwritten_ = 0, events_unwritten_ = 0;
};

}  // namespace condyle::hal
