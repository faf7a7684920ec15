// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "condyle/hal/clock.h"
#include "condyle/hal/log/session_log_reader.h"

namespace condyle::hal {

/// Replays one source of a session log: the same reports in the same order, and disconnected when
/// the device went away. Each recorded disconnection ends what open() began; opening again
/// continues after it, never at the start.
class SessionLogSource final : public ReportSource {
 public:
  /// Without a `clock`, reports come as fast as they are read. With one, which must count as the
  /// recording's clock did, they come when their time comes.
  explicit SessionLogSource(std::string path, std::size_t source_index = 0, Clock* clock = nullptr);

  /// Also bad_report if the log has no such source; problem() gives the reason.
  Status open() override;
  /// Also bad_report, once, if the file is damaged; then end. A log that was cut off ends with
  /// `end`, and condition() states what is lost.
  Status read(TimeNs deadline_ns, RawReport& report) override;
  void close() override { is_open_ = false; }
  /// From the recorded events.
  TransportCounts counts() const override { return counts_; }

  /// The header recorded with the reports; valid after open returned ok.
  const SessionHeader& header() const { return reader_.header(); }
  /// Whether the log is complete; final once read returned end or bad_report.
  const SessionLogCondition& condition() const { return reader_.condition(); }
  /// Reports and events of this source for which the recorder had no room, so far.
  std::uint64_t not_recorded() const { return not_recorded_; }
  /// Share of the log read so far, 0 to 1; valid after open returned ok.
  double progress() const { return reader_.progress(); }
  /// What is wrong with the file, and at which byte; empty if nothing is.
  std::string problem() const;

 private:
  bool take_event(const SessionEventRecord& event);

  std::string path_;
  std::size_t source_index_;
  Clock* clock_;
  SessionLogReader reader_;
  bool has_begun_ = false, is_open_ = false, has_failed_ = false, has_entry_ = false;
  bool has_source_ = true;
  SessionEntry entry_;
  TransportCounts counts_;
  std::uint64_t not_recorded_ = 0;
};

}  // namespace condyle::hal
