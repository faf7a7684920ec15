// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "condyle/hal/clock.h"
#include "condyle/hal/log/session_log.h"

namespace condyle::hal {

/// Passes a source's reports on and records them on the way, with its connections, disconnections
/// and faults, so that SessionLogSource gives what the source gave. The log may fail or be full:
/// reports come all the same, and SessionLogWriter::status tells.
class RecordedSource final : public ReportSource {
 public:
  /// `source` is number `source_index` of the log's header. `clock` is the one of its reports.
  RecordedSource(ReportSource& source, SessionLogWriter& log, std::size_t source_index,
                 Clock& clock);

  Status open() override;
  Status read(TimeNs deadline_ns, RawReport& report) override;
  void close() override { source_.close(); }
  TransportCounts counts() const override { return source_.counts(); }

 private:
  void record(SessionEvent kind, std::uint64_t count);
  void record_faults();

  ReportSource& source_;
  SessionLogWriter& log_;
  std::size_t source_index_;
  Clock& clock_;
  TransportCounts recorded_;
};

}  // namespace condyle::hal
