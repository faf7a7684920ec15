// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "condyle/hal/log/mcap_reader.h"
#include "condyle/hal/log/session_log.h"

namespace condyle::hal {

/// An event as it was recorded.
struct SessionEventRecord {
  TimeNs time_ns = 0;
  SessionEvent kind = SessionEvent::note;
  std::uint64_t count = 1;  ///< how often it happened; of not_recorded: how much is missing
  std::string_view text;    ///< lives until the next entry is read
};

/// A report or an event of one source. A source's entries come in the order in which they happened.
struct SessionEntry {
  std::size_t source_index = 0;
  bool is_event = false;
  RawReport report;          ///< if it is not an event
  SessionEventRecord event;  ///< if it is an event
};

/// How complete a log is.
struct SessionLogCondition {
  McapRead outcome = McapRead::record;        ///< `record`: not read to the end yet
  McapProblem problem;                        ///< of truncated and damaged
  std::uint64_t lost_bytes = 0;               ///< of the file, from the problem on
  std::optional<TimeNs> last_report_time_ns;  ///< of all sources, before the end or problem
};

/// One line for the user: "complete", or what is lost.
std::string describe(const SessionLogCondition& condition);

/// Reads what the estimator has learned during the session, as JSON; empty if the log has none,
/// as before its end. Otherwise as SessionLogReader::open.
Status read_learned_text(const std::string& path, std::string& text);

/// Reads a session log from start to end: all sources, one chunk in memory at a time. If a log is
/// cut off after its header, all of its complete chunks are read.
class SessionLogReader {
 public:
  SessionLogReader();

  /// Reads the header: ok, not_found, not_permitted or bad_report (condition().problem has the
  /// reason).
  Status open(const std::string& path);
  void close();

  /// Only after open gave ok.
  const SessionHeader& header() const { return header_; }

  /// Next entry: `record` with one, else why there is none, now and from then on. Does not
  /// allocate.
  McapRead next(SessionEntry& entry);

  const SessionLogCondition& condition() const { return condition_; }
  /// Share of the file read so far, 0 to 1, chunk by chunk; valid after open returned ok.
  double progress() const {
    return static_cast<double>(mcap_.sound_bytes()) / static_cast<double>(mcap_.size_bytes());
  }

 private:
  std::string take_header();
  bool take(const McapSchema& schema);
  bool take(const McapChannel& channel);
  bool take(const McapMessage& message, SessionEntry& entry);
  McapRead stop(McapRead outcome, std::string reason);

  McapReader mcap_;
  SessionHeader header_;
  std::array<std::uint32_t, 2 * kMaxSessionSources + 1> next_sequence_{};
  std::array<bool, 2 * kMaxSessionSources + 1> has_channel_{};
  SessionLogCondition condition_;
};

}  // namespace condyle::hal
